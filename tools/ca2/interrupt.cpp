#include "tools/ca2/interrupt.h"

#include <atomic>
#include <csignal>

#include "drivers/net/udp_source.h"

namespace ca2 {
namespace {

// A handler has no other way to know what to stop.
std::atomic<UdpSource*> interrupted_source{nullptr};
volatile std::sig_atomic_t was_raised = 0;

void handle(int) {
  was_raised = 1;
  if (UdpSource* source = interrupted_source.load()) source->stop();
}

}  // namespace

Interrupt::Interrupt(UdpSource* source) {
  was_raised = 0;
  interrupted_source = source;
  struct sigaction action {};
  action.sa_handler = handle;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

Interrupt::~Interrupt() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  interrupted_source = nullptr;
}

bool Interrupt::raised() {
  return was_raised != 0;
}

}  // namespace ca2
