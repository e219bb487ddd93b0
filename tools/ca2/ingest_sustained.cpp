#include "tools/ca2/ingest_sustained.h"

#include <sys/prctl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include "drivers/net/udp_sender.h"
#include "drivers/net/udp_source.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

/// Datagrams that a sender which was kept waiting sends at once to make up for it: a switch's buffer. Beyond
/// that it is as late as it is, for a wire does not go faster.
constexpr double most_late = 256;

/// The time it took, s.
Result<double> send_stream(UdpSender& sender, std::uint16_t port, const SustainedStream& stream,
                           std::uint64_t count) {
  ::prctl(PR_SET_TIMERSLACK, 1);  // of this thread
  std::vector<std::uint8_t> payload(stream.payload, 0x5a);
  const Clock::time_point begin = Clock::now();
  Clock::time_point start = begin;
  const auto after = [&](double datagrams) {
    return std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(datagrams / stream.rate));
  };
  for (std::uint64_t number = 0; number < count;) {
    for (int i = 0; i < stream.burst && number < count; ++i, ++number) {
      std::memcpy(payload.data(), &number, sizeof number);
      if (auto sent = sender.send(port, payload); !sent) return fail(sent.error());
    }
    const Clock::time_point next = start + after(static_cast<double>(number)), now = Clock::now();
    if (now > next + after(most_late)) start += now - next - after(most_late);
    if (now < next) std::this_thread::sleep_until(next);
  }
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

Result<SustainedIngest> measure_sustained(const SustainedStream& stream) {
  UdpSourceOptions options;
  options.ports = {0};
  options.socket.address = "127.0.0.1";
  options.socket.receive_buffer = stream.receive_buffer;
  const auto source = UdpSource::open(options);
  if (!source) return fail(source.error());
  auto sender = UdpSender::open("127.0.0.1");
  if (!sender) return fail(sender.error());

  SustainedIngest out;
  out.sent = static_cast<std::uint64_t>(std::ceil(stream.rate * stream.seconds));
  out.receive_buffer = (*source)->sockets()[0].receive_buffer;
  std::vector<bool> seen(out.sent);
  Result<double> sending = 0.0;
  std::atomic<bool> done = false;
  std::jthread thread([&] {
    sending = send_stream(*sender, (*source)->sockets()[0].port, stream, out.sent);
    done = true;
  });
  double receiving = 0;
  for (;;) {
    const bool last = done;
    const double start = cpu_ns();
    const Result<PacketBatch> batch = (*source)->next_batch(std::chrono::milliseconds(200));
    receiving += cpu_ns() - start;
    if (!batch) return fail(batch.error());
    if (batch->event != PacketEvent::packets && last) break;
    for (const Datagram& datagram : batch->datagrams) {
      std::uint64_t number = 0;
      if (datagram.payload.size() != stream.payload) continue;
      std::memcpy(&number, datagram.payload.data(), sizeof number);
      if (number >= out.sent || seen[number]) continue;
      seen[number] = true;
      ++out.received;
    }
  }
  thread.join();
  if (!sending) return fail(sending.error());
  out.seconds = *sending;
  out.kernel_dropped = (*source)->counters().kernel_dropped;
  out.cpu_ns = receiving / static_cast<double>(std::max<std::uint64_t>(out.received, 1));
  return out;
}

}  // namespace ca2
