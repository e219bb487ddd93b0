/// @file Which threads go first when there is less processor than work.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

namespace ca2 {

enum class Urgency { can_wait, cannot_wait };

/// The calling thread's work can wait: a search that finds no time is shed and counted, a solve comes later.
/// Datagrams and pictures cannot: who receives them, the event loop and the recorder go before it. Threads of
/// other services are not concerned: between services, their CPUWeight= decides.
inline void let_receivers_go_first() {
  constexpr int behind = 5;  // nice: a third of the share of who has that much less
  const auto thread = static_cast<id_t>(::gettid());
  // Where it is forbidden, all are alike. Of what the process has: a unit's Nice= moves all threads.
  static_cast<void>(::setpriority(PRIO_PROCESS, thread, ::getpriority(PRIO_PROCESS, thread) + behind));
}

}  // namespace ca2
