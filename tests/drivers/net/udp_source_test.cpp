#include "drivers/net/udp_source.h"

#include <gtest/gtest.h>
#include <net/if.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "drivers/net/udp_sender.h"
#include "tests/drivers/net/frames.h"
#include "tests/drivers/net/read_all.h"

namespace ca2 {
namespace {

using namespace ca2::test;
using namespace std::chrono_literals;

std::unique_ptr<UdpSource> source_on(std::vector<std::uint16_t> ports, UdpSourceOptions options = {}) {
  options.ports = std::move(ports);
  if (options.socket.address.empty()) options.socket.address = "127.0.0.1";
  auto source = UdpSource::open(options);
  EXPECT_TRUE(source) << (source ? "" : source.error().text());
  return source ? std::move(*source) : nullptr;
}

/// Until `count` are there or nothing comes for 2 s.
std::vector<KeptDatagram> receive(UdpSource& source, std::size_t count) {
  std::vector<KeptDatagram> all;
  while (all.size() < count) {
    const auto batch = source.next_batch(2s);
    if (!batch || batch->event != PacketEvent::packets) break;
    for (const Datagram& datagram : batch->datagrams) all.push_back(keep(datagram));
  }
  return all;
}

void send(const std::string& host, std::uint16_t port, const Bytes& payload) {
  auto sender = UdpSender::open(host);
  ASSERT_TRUE(sender) << sender.error().text();
  const auto sent = sender->send(port, payload);
  ASSERT_TRUE(sent) << sent.error().text();
}

std::int64_t now_utc() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

TEST(UdpSource, ReceivesInOrderWithTheKernelsTime) {
  const auto source = source_on({0});
  const std::uint16_t port = source->sockets()[0].port;
  auto sender = UdpSender::open("127.0.0.1");
  ASSERT_TRUE(sender);
  const std::int64_t before = now_utc();
  std::vector<KeptDatagram> all;
  for (unsigned i = 0; i < 200; ++i) {
    ASSERT_TRUE(sender->send(port, pattern(1206, i)));
    if (i % 40 != 39) continue;  // few enough at a time for the smallest of buffers
    for (KeptDatagram& datagram : receive(*source, 40)) all.push_back(std::move(datagram));
  }
  const std::int64_t after = now_utc();
  ASSERT_EQ(all.size(), 200u);
  for (unsigned i = 0; i < 200; ++i) {
    EXPECT_EQ(all[i].payload, pattern(1206, i));
    EXPECT_EQ(all[i].source_address, "127.0.0.1");
    EXPECT_EQ(all[i].destination_port, port);
    EXPECT_NE(all[i].source_port, 0);
    EXPECT_GE(all[i].time, i == 0 ? before - 1'000'000 : all[i - 1].time);
    EXPECT_LE(all[i].time, after + 1'000'000);
  }
  EXPECT_EQ(source->counters().without_kernel_time, 0u);
  EXPECT_EQ(source->counters().datagrams, 200u);
  EXPECT_EQ(source->counters().bytes, 200u * 1206u);
  EXPECT_EQ(source->counters().lost(), 0u);
}

TEST(UdpSource, TakesTheLargestDatagramAndTheEmptyOne) {
  const auto source = source_on({0});
  const std::uint16_t port = source->sockets()[0].port;
  send("127.0.0.1", port, pattern(65507));
  send("127.0.0.1", port, {});
  const auto all = receive(*source, 2);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].payload, pattern(65507));
  EXPECT_FALSE(all[0].truncated);
  EXPECT_TRUE(all[1].payload.empty());
}

TEST(UdpSource, HearsBothFamiliesOnOneSocket) {
  UdpSourceOptions options;
  options.ports = {0};
  auto source = UdpSource::open(options);
  ASSERT_TRUE(source) << source.error().text();
  const UdpSocket& socket = (*source)->sockets()[0];
  EXPECT_TRUE(socket.v4);
  if (!socket.v6) GTEST_SKIP() << "this host has no IPv6: the fallback to IPv4 was taken";
  send("127.0.0.1", socket.port, pattern(10));
  send("::1", socket.port, pattern(20));
  const auto all = receive(**source, 2);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].source_address, "127.0.0.1") << "not ::ffff:127.0.0.1";
  EXPECT_EQ(all[1].source_address, "::1");
}

TEST(UdpSource, MarksWhatIsLongerThanItsBuffer) {
  UdpSourceOptions options;
  options.largest_payload = 1207;  // one more than expected tells an oversize stray from a packet
  const auto source = source_on({0}, options);
  const std::uint16_t port = source->sockets()[0].port;
  send("127.0.0.1", port, pattern(1206));
  send("127.0.0.1", port, pattern(1208));
  const auto all = receive(*source, 2);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_FALSE(all[0].truncated);
  EXPECT_TRUE(all[1].truncated);
  EXPECT_EQ(all[1].payload.size(), 1207u);
  EXPECT_EQ(source->counters().cut_short, 1u);
}

TEST(UdpSource, KeepsToTheSourcesAskedFor) {
  UdpSourceOptions options;
  options.sources = {"127.0.0.9"};
  const auto source = source_on({0}, options);
  send("127.0.0.1", source->sockets()[0].port, pattern(10));
  const auto batch = source->next_batch(50ms);
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->event, PacketEvent::timeout);
  EXPECT_EQ(source->counters().other_source, 1u);
}

TEST(UdpSource, ListensToSeveralPortsInTheOrderOfTime) {
  const auto source = source_on({0, 0, 0});
  auto sender = UdpSender::open("127.0.0.1");
  ASSERT_TRUE(sender);
  for (unsigned i = 0; i < 90; ++i) {
    ASSERT_TRUE(sender->send(source->sockets()[(i * 7) % 3].port, pattern(20, i)));
  }
  const auto all = receive(*source, 90);
  ASSERT_EQ(all.size(), 90u);
  for (unsigned i = 0; i < 90; ++i) {
    EXPECT_EQ(all[i].payload, pattern(20, i));
    EXPECT_EQ(all[i].destination_port, source->sockets()[(i * 7) % 3].port);
  }
}

TEST(UdpSource, WakesAtOnceWhenStoppedAndStaysStopped) {
  const auto source = source_on({0});
  const auto start = std::chrono::steady_clock::now();
  std::thread stopper([&] {
    std::this_thread::sleep_for(50ms);
    source->stop();
  });
  const auto batch = source->next_batch(60s);
  stopper.join();
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->event, PacketEvent::stopped);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 5s);
  send("127.0.0.1", source->sockets()[0].port, pattern(10));
  EXPECT_EQ(source->next_batch(60s)->event, PacketEvent::stopped);
}

TEST(UdpSource, TimesOut) {
  const auto source = source_on({0});
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(source->next_batch(30ms)->event, PacketEvent::timeout);
  EXPECT_GE(std::chrono::steady_clock::now() - start, 30ms);
  EXPECT_EQ(source->next_batch(0ms)->event, PacketEvent::timeout);
}

TEST(UdpSource, AccountsForEveryDatagramTheKernelDropped) {
  UdpSourceOptions options;
  options.socket.receive_buffer = 32 * 1024;
  const auto source = source_on({0}, options);
  const std::uint16_t port = source->sockets()[0].port;
  auto sender = UdpSender::open("127.0.0.1");
  ASSERT_TRUE(sender);
  for (unsigned i = 0; i < 500; ++i) ASSERT_TRUE(sender->send(port, pattern(1206, i)));
  std::size_t received = 0;
  for (;;) {
    const auto batch = source->next_batch(50ms);
    ASSERT_TRUE(batch);
    if (batch->event != PacketEvent::packets) break;
    received += batch->datagrams.size();
  }
  ASSERT_LT(received, 500u) << "the buffer was to overflow";
  ASSERT_TRUE(sender->send(port, pattern(1206)));  // carries the count of the drops before it
  EXPECT_EQ(receive(*source, 1).size(), 1u);
  EXPECT_EQ(source->counters().kernel_dropped, 500 - received);
  EXPECT_EQ(source->counters().lost(), 500 - received);
}

TEST(UdpSource, SaysWhatBufferTheKernelGranted) {
  UdpSourceOptions options;
  options.socket.receive_buffer = std::size_t{1} << 30;
  const auto source = source_on({0}, options);
  const UdpSocket& capped = source->sockets()[0];
  EXPECT_EQ(capped.receive_buffer_asked, std::size_t{1} << 30);
  EXPECT_GT(capped.receive_buffer, 0u);
  if (capped.receive_buffer < capped.receive_buffer_asked) {
    EXPECT_NE(capped.warning.find("net.core.rmem_max=1073741824"), std::string::npos) << capped.warning;
  }
  options.socket.receive_buffer = 64 * 1024;
  const auto modest = source_on({0}, options);
  EXPECT_EQ(modest->sockets()[0].receive_buffer, 64u * 1024u);
  EXPECT_TRUE(modest->sockets()[0].warning.empty());
}

TEST(UdpSource, RefusesAPortInUseUnlessBothShare) {
  UdpSourceOptions options;
  options.socket.address = "127.0.0.1";
  const auto first = source_on({0}, options);
  options.ports = {first->sockets()[0].port};
  const auto second = UdpSource::open(options);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::unavailable);
  EXPECT_NE(second.error().text().find("in use"), std::string::npos) << second.error().text();

  options.socket.share_port = true;
  EXPECT_FALSE(UdpSource::open(options)) << "the first one does not share";
  options.ports = {0};
  const auto third = source_on({0}, options);
  options.ports = {third->sockets()[0].port};
  EXPECT_TRUE(UdpSource::open(options));
}

class Multicast : public testing::TestWithParam<const char*> {};

TEST_P(Multicast, IsReceived) {
  const std::string group = GetParam();
  const bool v6 = group.find(':') != std::string::npos;
  UdpSourceOptions options;
  options.ports = {0};
  options.socket.multicast_group = group;
  options.socket.interface = "lo";
  auto source = UdpSource::open(options);
  if (!source) GTEST_SKIP() << "no multicast on the loopback here: " << source.error().text();
  // Sent out of the loopback interface alone.
  UniqueFd sender(::socket(v6 ? AF_INET6 : AF_INET, SOCK_DGRAM, 0));
  const int index = static_cast<int>(if_nametoindex("lo"));
  ip_mreqn request{};
  request.imr_ifindex = index;
  const int set = v6 ? ::setsockopt(sender.get(), IPPROTO_IPV6, IPV6_MULTICAST_IF, &index, sizeof index)
                     : ::setsockopt(sender.get(), IPPROTO_IP, IP_MULTICAST_IF, &request, sizeof request);
  ASSERT_EQ(set, 0);
  sockaddr_storage to{};
  const socklen_t length =
      to_sockaddr(*parse_ip_address(group), (*source)->sockets()[0].port, static_cast<unsigned>(index), to);
  const Bytes payload = pattern(48);
  if (::sendto(sender.get(), payload.data(), payload.size(), 0, reinterpret_cast<sockaddr*>(&to), length) <
      0) {
    GTEST_SKIP() << "this host cannot send multicast on the loopback: " << std::strerror(errno);
  }
  const auto all = receive(**source, 1);
  ASSERT_EQ(all.size(), 1u) << group;
  EXPECT_EQ(all[0].payload, payload);
}

INSTANTIATE_TEST_SUITE_P(UdpSource, Multicast, testing::Values("239.255.77.7", "ff01::7777"));

TEST(UdpSource, SaysWhatIsWrongWithItsOptions) {
  const auto code_of = [](const UdpSocketOptions& options) {
    const auto socket = open_udp_socket(options);
    return socket ? 0 : static_cast<int>(socket.error().code);
  };
  UdpSocketOptions options;
  options.address = "lidar.local";
  EXPECT_EQ(code_of(options), static_cast<int>(ErrorCode::usage));
  options.address = "192.0.2.99";  // TEST-NET: nobody has it
  EXPECT_EQ(code_of(options), static_cast<int>(ErrorCode::unavailable));
  options.address = "127.0.0.1";
  options.multicast_group = "ff02::1";
  EXPECT_EQ(code_of(options), static_cast<int>(ErrorCode::usage)) << "two families";
  options.multicast_group = "192.0.2.1";
  EXPECT_EQ(code_of(options), static_cast<int>(ErrorCode::usage)) << "no group";
  options.multicast_group = "";
  options.interface = "no-such-if";
  EXPECT_EQ(code_of(options), static_cast<int>(ErrorCode::unavailable));
}

TEST(UdpSender, SaysWhatItCannotDo) {
  EXPECT_FALSE(UdpSender::open("no-such-host.invalid"));
  auto sender = UdpSender::open("127.0.0.1");
  ASSERT_TRUE(sender);
  const auto sent = sender->send(9, pattern(65508));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, ErrorCode::io);
}

}  // namespace
}  // namespace ca2
