#include "tools/ca2/ingest_cost.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "drivers/net/udp_sender.h"
#include "drivers/net/udp_source.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

Result<void> send_burst(UdpSender& sender, std::uint16_t port, const std::vector<std::uint8_t>& payload,
                        std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (auto sent = sender.send(port, payload); !sent) return sent;
  }
  return {};
}

tl::unexpected<Error> missing() {
  return fail(ErrorCode::io, "loopback", "datagrams were lost",
              "net.core.rmem_max is too small for the burst");
}

Result<void> take_batched(UdpSource& source, std::uint64_t count) {
  while (count > 0) {
    const Result<PacketBatch> batch = source.next_batch(std::chrono::seconds(2));
    if (!batch) return fail(batch.error());
    if (batch->event != PacketEvent::packets) return missing();
    count -= std::min<std::uint64_t>(count, batch->datagrams.size());
  }
  return {};
}

Result<void> take_one_by_one(int fd, std::uint64_t count) {
  static thread_local std::uint8_t buffer[65536];
  alignas(cmsghdr) unsigned char control[CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))];
  for (; count > 0; --count) {
    sockaddr_storage sender{};
    iovec vector{buffer, sizeof buffer};
    msghdr header{};
    header.msg_name = &sender;
    header.msg_namelen = sizeof sender;
    header.msg_iov = &vector;
    header.msg_iovlen = 1;
    header.msg_control = control;
    header.msg_controllen = sizeof control;
    if (::recvmsg(fd, &header, MSG_DONTWAIT) < 0 || CMSG_FIRSTHDR(&header) == nullptr) return missing();
  }
  return {};
}

}  // namespace

Result<IngestCost> measure_ingest(std::size_t payload, std::uint64_t datagrams) {
  UdpSourceOptions options;
  options.ports = {0};
  options.socket.address = "127.0.0.1";
  const auto source = UdpSource::open(options);
  if (!source) return fail(source.error());
  auto plain = open_udp_socket(options.socket);
  if (!plain) return fail(plain.error());
  auto sender = UdpSender::open("127.0.0.1");
  if (!sender) return fail(sender.error());

  // What the smallest of default receive buffers holds, with the kernel's overhead.
  const std::uint64_t burst = std::clamp<std::uint64_t>(100'000 / (payload + 1), 1, 64);
  const std::vector<std::uint8_t> content(payload, 0x5a);
  IngestCost cost;
  cost.payload = payload;
  const std::uint64_t warm_up = std::min<std::uint64_t>(datagrams / 10, 5000);
  for (std::uint64_t done = 0; done < datagrams + warm_up; done += burst) {
    const bool counts = done >= warm_up;
    if (auto sent = send_burst(*sender, (*source)->sockets()[0].port, content, burst); !sent)
      return fail(sent.error());
    double start = cpu_ns();
    if (auto taken = take_batched(**source, burst); !taken) return fail(taken.error());
    if (counts) cost.batched_ns += cpu_ns() - start;

    if (auto sent = send_burst(*sender, plain->port, content, burst); !sent) return fail(sent.error());
    start = cpu_ns();
    if (auto taken = take_one_by_one(plain->fd.get(), burst); !taken) return fail(taken.error());
    if (counts) {
      cost.one_by_one_ns += cpu_ns() - start;
      cost.datagrams += burst;
    }
  }
  cost.batched_ns /= static_cast<double>(std::max<std::uint64_t>(cost.datagrams, 1));
  cost.one_by_one_ns /= static_cast<double>(std::max<std::uint64_t>(cost.datagrams, 1));
  return cost;
}

}  // namespace ca2
