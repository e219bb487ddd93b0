/// @file What system tests need and no common tool does: noise, a frozen thread, systemd's end of sd_notify.
#include <lcm/lcm.h>
#include <poll.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <arpa/inet.h>
#include <ca2/command_v1_t.hpp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace {

using Bytes = std::vector<std::uint8_t>;

int unix_socket(int type, const std::string& path, bool listen) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  const int fd = ::socket(AF_UNIX, type, 0);
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  const int failed = listen ? ::bind(fd, generic, sizeof(address)) : ::connect(fd, generic, sizeof(address));
  if (failed != 0) std::perror(path.c_str());
  return failed != 0 ? -1 : fd;
}

/// Every message is a line or more of the file, written at once.
int notify(const std::string& path, const std::string& file) {
  const int fd = unix_socket(SOCK_DGRAM, path, true);
  std::ofstream out(file);
  char bytes[4096];
  for (ssize_t size = 0; fd >= 0 && (size = ::recv(fd, bytes, sizeof(bytes), 0)) >= 0;) {
    out.write(bytes, size) << std::endl;
  }
  return 1;
}

/// Stops one thread of a process, as a driver that hangs would.
int freeze(pid_t process, const std::string& name, unsigned seconds) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task")) {
    std::string comm;
    std::getline(std::ifstream(task.path() / "comm"), comm);
    if (comm != name.substr(0, 15)) continue;
    const pid_t thread = std::stoi(task.path().filename());
    if (::ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0 ||
        ::ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) != 0) {
      std::perror("ptrace");
      return 1;
    }
    ::waitpid(thread, nullptr, __WALL);
    // A process cannot end before its tracer has heard that the thread did.
    for (unsigned i = 0; i < 20 * seconds; ++i) {
      if (::waitpid(thread, nullptr, __WALL | WNOHANG) != 0) return 0;
      ::usleep(50'000);
    }
    ::ptrace(PTRACE_DETACH, thread, nullptr, nullptr);
    return 0;
  }
  std::fprintf(stderr, "no thread '%s'\n", name.c_str());
  return 1;
}

/// Commands that are no commands: random bytes, good ones with bytes changed or cut off; and datagrams that
/// are no LCM.
int flood(const char* url, int count) {
  lcm_t* lcm = lcm_create(url);
  if (!lcm) return 1;
  std::mt19937 random(1);
  ca2::command_v1_t command{};
  command.sender = "pilot";
  command.command = "drop_last";
  command.arguments = "{}";
  Bytes good(static_cast<std::size_t>(command.getEncodedSize()));
  command.encode(good.data(), 0, static_cast<int>(good.size()));

  const int udp = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(7667);
  group.sin_addr.s_addr = inet_addr("239.255.76.67");
  for (int i = 0; i < count; ++i) {
    Bytes bytes = good;
    if (i % 3 == 0) {
      bytes.resize(random() % 3000);
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    } else if (i % 3 == 1) {
      for (int change = 0; change < 3; ++change) {
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      }
    } else {
      bytes.resize(random() % bytes.size());
    }
    lcm_publish(lcm, "CA2_COMMAND", bytes.data(), static_cast<unsigned>(bytes.size()));
    ::sendto(udp, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&group), sizeof(group));
    if (i % 100 == 0) ::usleep(1000);
  }
  lcm_destroy(lcm);
  return 0;
}

/// Says one thing on a connection of its own; true when the daemon answers or closes within two seconds.
bool say(const std::string& path, const std::string& text) {
  const int fd = unix_socket(SOCK_STREAM, path, false);
  if (fd < 0) return false;
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t size = ::send(fd, text.data() + done, text.size() - done, MSG_NOSIGNAL);
    if (size <= 0) break;
    done += static_cast<std::size_t>(size);
  }
  std::string heard;
  pollfd wait{fd, POLLIN, 0};
  bool answered = false;
  while (!answered && ::poll(&wait, 1, 2000) > 0) {
    char bytes[4096];
    const ssize_t size = ::recv(fd, bytes, sizeof(bytes), 0);
    if (size > 0) heard.append(bytes, static_cast<std::size_t>(size));
    // The hello is the first line; an error to what was said, the second.
    answered = size <= 0 || heard.find("\"error\"") != std::string::npos;
  }
  ::close(fd);
  return answered;
}

int socket_noise(const std::string& path) {
  const std::string requests[] = {
      "hello\n",
      "{}\n",
      "[]\n",
      "null\n",
      "{\"id\":1}\n",
      "{\"id\":1,\"command\":7}\n",
      "{\"id\":1,\"command\":\"capture\",\"arguments\":[1]}\n",
      "{\"id\":1,\"command\":\"drop\",\"arguments\":{\"view\":\"one\",\"more\":1}}\n",
      "{\"id\":1,\"command\":\"pick\",\"arguments\":{\"lidar\":\"top\",\"row\":1e99,\"column\":-1}}\n",
      "{\"id\":1,\"command\":\"session_use\",\"arguments\":{\"name\":\"../../etc\"}}\n",
      "{\"id\":1,\"command\":\"record_start\",\"arguments\":{\"name\":\"../x\"}}\n",
      "{\"id\":1,\"command\":\"preview\",\"arguments\":{\"sensor\":\"none\",\"width\":0}}\n",
      std::string(100'000, '[') + "\n",
      std::string(1'000'000, 'x'),
      "{\"id\":1,\"command\":\"" + std::string(60'000, '\xff') + "\"}\n"};
  for (const std::string& request : requests) {
    if (say(path, request)) continue;
    std::fprintf(stderr, "no answer to %.60s\n", request.c_str());
    return 1;
  }
  return 0;
}

/// Connections that say nothing.
int hold(const std::string& path, int count) {
  for (int i = 0; i < count; ++i) {
    if (unix_socket(SOCK_STREAM, path, false) < 0) return 1;
  }
  ::pause();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "notify" && argc == 4) return notify(argv[2], argv[3]);
  if (what == "freeze" && argc == 5) {
    return freeze(std::stoi(argv[2]), argv[3], static_cast<unsigned>(std::stoi(argv[4])));
  }
  if (what == "flood" && argc == 4) return flood(argv[2], std::stoi(argv[3]));
  if (what == "hold" && argc == 4) return hold(argv[2], std::stoi(argv[3]));
  if (what == "socket" && argc == 3) return socket_noise(argv[2]);
  std::fprintf(stderr,
               "system_probe notify SOCKET FILE | freeze PID THREAD SECONDS | flood URL COUNT | socket PATH "
               "| hold PATH COUNT\n");
  return 64;
}
