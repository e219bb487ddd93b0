/// @file A network of the test's own: nothing outside hears it or is heard.
#pragma once

#include <arpa/inet.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <string>

namespace ca2::test {

/// Moves this thread, and what it starts from now on, to a network namespace whose loopback is up, with the
/// addresses 127.0.0.1 to 127.0.0.`addresses`. False where the system does not let us (containers without
/// privileges).
inline bool enter_private_network(int addresses) {
  if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  bool good = true;
  for (int i = 1; i <= addresses && good; ++i) {
    ifreq request{};
    // The first is the interface's, the others are its aliases'.
    const std::string name = i == 1 ? "lo" : "lo:" + std::to_string(i);
    std::memcpy(request.ifr_name, name.c_str(), std::min(name.size(), sizeof request.ifr_name - 1));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK - 1 + static_cast<unsigned>(i));
    std::memcpy(&request.ifr_addr, &address, sizeof address);
    good = ::ioctl(fd, SIOCSIFADDR, &request) == 0;
    address.sin_addr.s_addr = ::htonl(0xff000000);
    std::memcpy(&request.ifr_netmask, &address, sizeof address);
    good = good && ::ioctl(fd, SIOCSIFNETMASK, &request) == 0;
    request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK;
    good = good && ::ioctl(fd, SIOCSIFFLAGS, &request) == 0;
  }
  ::close(fd);
  return good;
}

}  // namespace ca2::test
