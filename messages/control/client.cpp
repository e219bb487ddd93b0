#include "messages/control/client.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/io/json.h"
#include "messages/control/line_buffer.h"
#include "messages/control/protocol.h"
#include "messages/error_json.h"

namespace ca2::control {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr std::chrono::seconds hello_timeout{5};
constexpr std::chrono::seconds send_timeout{5};

tl::unexpected<Error> gone() {
  return fail(ErrorCode::unavailable, "", "the daemon closed the connection",
              "`journalctl -u ca2d` tells why");
}

/// False when the time is up.
bool wait_for(int fd, short events, Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd entry{fd, events, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::max<long>(0, static_cast<long>(left))));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

}  // namespace

struct Client::State {
  int fd = -1;
  LineBuffer lines{max_reply};
  std::int64_t last_id = 0;

  ~State() {
    if (fd >= 0) ::close(fd);
  }
};

Client::Client(std::unique_ptr<State> state) : state_(std::move(state)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<Client> Client::connect(const std::filesystem::path& socket) {
  const std::string path = socket.string();
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    return fail(ErrorCode::usage, path, "is no path of a socket: 1 to 107 bytes");
  }
  path.copy(address.sun_path, path.size());
  auto state = std::make_unique<State>();
  state->fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (state->fd < 0) return fail(ErrorCode::io, path, std::generic_category().message(errno));
  if (::connect(state->fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    if (errno == EACCES || errno == EPERM) {
      return fail(ErrorCode::no_permission, path, "this user may not talk to the daemon",
                  "join the group 'ca2', or use sudo");
    }
    return fail(ErrorCode::unavailable, path,
                "no daemon listens there: " + std::generic_category().message(errno),
                "start it: systemctl start ca2d; another socket: --socket");
  }
  Client client(std::move(state));
  const Result<json> hello = client.next(hello_timeout);
  if (!hello) return fail(hello.error());
  if (hello->is_object() && hello->value("type", "") == "error")
    return fail(error_from_json(hello->at("error")));
  if (!hello->is_object() || hello->value("type", "") != "hello" || hello->value("protocol", 0) != version) {
    return fail(ErrorCode::data, path,
                "what listens there does not speak protocol " + std::to_string(version) + " of ca2d",
                "are the daemon and this program of the same version?");
  }
  return client;
}

Result<std::int64_t> Client::send(const std::string& command, const json& arguments) {
  const std::int64_t id = ++state_->last_id;
  const json request{{"id", id}, {"command", command}, {"arguments", arguments}};
  const std::string line = request.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  const auto deadline = Clock::now() + send_timeout;
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t n = ::send(state_->fd, line.data() + done, line.size() - done, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n < 0 && errno == EAGAIN && wait_for(state_->fd, POLLOUT, deadline)) {
      continue;
    } else if (n >= 0 || errno != EINTR) {
      return gone();
    }
  }
  return id;
}

Result<json> Client::next(std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  while (true) {
    if (const auto line = state_->lines.next()) {
      json message = parse_json(*line);
      if (message.is_discarded() || !message.is_object()) {
        return fail(ErrorCode::data, "", "the daemon sent something that is not JSON");
      }
      return message;
    }
    if (state_->lines.overlong()) return fail(ErrorCode::data, "", "the daemon sent an endless line");
    if (!wait_for(state_->fd, POLLIN, deadline)) return json(nullptr);
    char bytes[65536];
    const ssize_t n = ::recv(state_->fd, bytes, sizeof(bytes), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return gone();
    state_->lines.append(std::string_view(bytes, static_cast<std::size_t>(n)));
  }
}

Result<json> Client::call(const std::string& command, const json& arguments,
                          std::chrono::milliseconds timeout) {
  const Result<std::int64_t> id = send(command, arguments);
  if (!id) return fail(id.error());
  const auto deadline = Clock::now() + timeout;
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    const Result<json> message = next(std::max(left, std::chrono::milliseconds(0)));
    if (!message) return fail(message.error());
    if (message->is_null()) {
      return fail(ErrorCode::unavailable, "", "the daemon did not answer '" + command + "' in time",
                  "`ca2 status` tells what it is doing");
    }
    if (message->value("id", std::int64_t{0}) == *id) return reply_from_json(*message);
  }
}

int Client::descriptor() const {
  return state_->fd;
}

}  // namespace ca2::control
