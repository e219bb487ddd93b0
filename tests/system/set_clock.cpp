/// @file Loaded before a program's libraries: its real-time clock is off by what the file named in
/// CA2_CLOCK_OFFSET says, ns in a line, and is set whenever the file changes. Other clocks stay as they are.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

using ClockGettime = int (*)(clockid_t, timespec*);
using Recvmmsg = int (*)(int, mmsghdr*, unsigned, int, timespec*);

long long offset() {
  const char* name = std::getenv("CA2_CLOCK_OFFSET");
  const int fd = name ? ::open(name, O_RDONLY | O_CLOEXEC) : -1;
  char text[32] = {};
  if (fd >= 0 && ::read(fd, text, sizeof text - 1) < 0) text[0] = 0;
  if (fd >= 0) ::close(fd);
  return std::atoll(text);
}

timespec moved(timespec time) {
  const long long ns = time.tv_nsec + offset();
  const long long seconds = ns >= 0 ? ns / 1'000'000'000 : (ns - 999'999'999) / 1'000'000'000;
  time.tv_sec += static_cast<time_t>(seconds);
  time.tv_nsec = static_cast<long>(ns - 1'000'000'000 * seconds);
  return time;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) {
  static const auto real = reinterpret_cast<ClockGettime>(::dlsym(RTLD_NEXT, "clock_gettime"));
  const int result = real(clock, time);
  if (result == 0 && clock == CLOCK_REALTIME) *time = moved(*time);
  return result;
}

extern "C" int gettimeofday(timeval* time, void*) {
  timespec now;
  const int result = ::clock_gettime(CLOCK_REALTIME, &now);
  if (result == 0) *time = {now.tv_sec, now.tv_nsec / 1000};
  return result;
}

extern "C" int recvmmsg(int fd, mmsghdr* messages, unsigned size, int flags, timespec* timeout) {
  static const auto real = reinterpret_cast<Recvmmsg>(::dlsym(RTLD_NEXT, "recvmmsg"));
  const int count = real(fd, messages, size, flags, timeout);
  for (int i = 0; i < count; ++i) {
    msghdr& header = messages[i].msg_hdr;
    for (cmsghdr* extra = CMSG_FIRSTHDR(&header); extra; extra = CMSG_NXTHDR(&header, extra)) {
      if (extra->cmsg_level != SOL_SOCKET || extra->cmsg_type != SCM_TIMESTAMPNS) continue;
      timespec stamp;
      std::memcpy(&stamp, CMSG_DATA(extra), sizeof stamp);
      stamp = moved(stamp);
      std::memcpy(CMSG_DATA(extra), &stamp, sizeof stamp);
    }
  }
  return count;
}
