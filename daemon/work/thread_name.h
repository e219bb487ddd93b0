/// @file What `top -H`, debuggers and the log call a thread.
#pragma once

#include <pthread.h>

#include <string>

namespace ca2 {

/// Of the calling thread; the kernel keeps 15 characters.
inline void name_thread(const std::string& name) {
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
}

}  // namespace ca2
