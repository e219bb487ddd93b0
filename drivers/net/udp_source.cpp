#include "drivers/net/udp_source.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>

#include "drivers/net/stop_event.h"
#include "drivers/net/udp_receiver.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

/// Being woken costs more than a datagram: where they come closer than this, they are left to gather for a
/// while. The kernel stamps them as they arrive, and its smallest receive buffer holds them.
constexpr microseconds dense{200}, gathering{500};

}  // namespace

struct UdpSource::State {
  std::vector<UdpSocket> sockets;
  std::vector<UdpReceiver> receivers;  ///< of each socket
  DatagramFilter filter;
  StopEvent stopped;
  std::vector<pollfd> polled;
  std::vector<Datagram> datagrams;
  PacketCounters counters;
  Clock::time_point woken;       ///< the last time
  std::int64_t since_woken = 0;  ///< datagrams received

  /// After poll.
  void gather() {
    if (Clock::now() - woken < since_woken * dense) std::this_thread::sleep_for(gathering);
    woken = Clock::now();
    since_woken = 0;
  }

  /// Everything at hand on all sockets, in the order of time.
  Result<void> receive() {
    datagrams.clear();
    bool sorted = true;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      const std::size_t before = datagrams.size();
      const int code = receivers[i].receive(filter, datagrams, counters);
      if (code != 0) {
        return fail(ErrorCode::io, "UDP port " + std::to_string(sockets[i].port),
                    std::string("cannot receive: ") + std::strerror(code));
      }
      sorted = sorted && (before == 0 || before == datagrams.size());
    }
    since_woken += static_cast<std::int64_t>(datagrams.size());
    if (!sorted) {
      std::stable_sort(datagrams.begin(), datagrams.end(),
                       [](const Datagram& a, const Datagram& b) { return a.time < b.time; });
    }
    return {};
  }
};

UdpSource::UdpSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
UdpSource::~UdpSource() = default;

Result<std::unique_ptr<UdpSource>> UdpSource::open(const UdpSourceOptions& options) {
  auto state = std::make_unique<State>();
  Result<std::vector<IpAddress>> sources = parse_sources(options.sources);
  if (!sources) return fail(std::move(sources.error()));
  state->filter.sources = std::move(*sources);
  if (!state->stopped.valid()) return fail(ErrorCode::io, "eventfd", std::strerror(errno));
  for (const std::uint16_t port : options.ports) {
    UdpSocketOptions socket = options.socket;
    socket.port = port;
    Result<UdpSocket> opened = open_udp_socket(socket);
    if (!opened) return fail(std::move(opened.error()));
    state->polled.push_back({opened->fd.get(), POLLIN, 0});
    state->receivers.emplace_back(opened->fd.get(), opened->port, options.largest_payload);
    state->sockets.push_back(std::move(*opened));
  }
  state->polled.push_back({state->stopped.fd(), POLLIN, 0});
  return std::unique_ptr<UdpSource>(new UdpSource(std::move(state)));
}

Result<PacketBatch> UdpSource::next_batch(std::chrono::milliseconds timeout) {
  State& state = *state_;
  const Clock::time_point deadline = Clock::now() + timeout;
  for (;;) {
    if (state.stopped.is_set()) return PacketBatch{PacketEvent::stopped, {}};
    if (auto received = state.receive(); !received) return fail(std::move(received.error()));
    if (!state.datagrams.empty()) return PacketBatch{PacketEvent::packets, state.datagrams};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) return PacketBatch{PacketEvent::timeout, {}};
    const int wait = static_cast<int>(std::min<std::int64_t>(left.count(), 60'000));
    if (::poll(state.polled.data(), state.polled.size(), wait) < 0 && errno != EINTR) {
      return fail(ErrorCode::io, "poll", std::strerror(errno));
    }
    state.gather();
  }
}

void UdpSource::stop() noexcept {
  state_->stopped.set();
}

const PacketCounters& UdpSource::counters() const {
  return state_->counters;
}

const std::vector<UdpSocket>& UdpSource::sockets() const {
  return state_->sockets;
}

}  // namespace ca2
