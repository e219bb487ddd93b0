/// @file One path: a capture read from the file, replayed over the loopback in time, and as fast as it goes,
/// gives the same scans, bit for bit.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

#include "drivers/lidar/lidar_driver.h"
#include "drivers/net/pacer.h"
#include "drivers/net/pcap_reader.h"
#include "drivers/net/udp_sender.h"
#include "drivers/net/udp_source.h"
#include "tests/drivers/net/read_all.h"

namespace ca2 {
namespace {

using namespace ca2::test;

struct ReplayCase {
  const char* name;
  const char* capture;
  const char* model;     ///< or empty
  const char* metadata;  ///< or empty
  std::uint16_t port;
  std::size_t scans;
};

/// Decodes datagrams as they come.
class Decoding {
 public:
  explicit Decoding(const LidarModelSpec& spec) : driver_(*LidarDriver::open(spec)) {}
  void push(const Datagram& datagram) { driver_.push(datagram, sink()); }
  std::vector<LidarScan> finish() {
    driver_.flush(sink());
    return std::move(scans_);
  }

 private:
  LidarSink sink() {
    return [this](LidarScan&& scan) { scans_.push_back(std::move(scan)); };
  }
  LidarDriver driver_;
  std::vector<LidarScan> scans_;
};

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(static_cast<const void*>(a.data()), b.data(), a.size() * sizeof(T)) == 0);
}

/// All that a sensor's packets say. What the host's clock adds is left out: when the packets arrived, and,
/// with a Velodyne, in which hour.
void expect_same(const std::vector<LidarScan>& left, const std::vector<LidarScan>& right) {
  constexpr std::int64_t hour = 3'600'000'000'000;
  ASSERT_EQ(left.size(), right.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const LidarScan &a = left[i], &b = right[i];
    EXPECT_TRUE(same_bits(a.scan.points, b.scan.points));
    EXPECT_TRUE(same_bits(a.scan.intensity, b.scan.intensity));
    EXPECT_TRUE(same_bits(a.scan.range, b.scan.range));
    EXPECT_TRUE(same_bits(a.scan.ring, b.scan.ring));
    EXPECT_TRUE(same_bits(a.scan.column, b.scan.column));
    ASSERT_EQ(a.scan.time.size(), b.scan.time.size());
    for (std::size_t k = 0; k < a.scan.time.size(); ++k) {
      ASSERT_EQ((a.scan.time[k] - b.scan.time[k]) % hour, 0);
    }
    EXPECT_EQ(a.frame_id, b.frame_id);
    EXPECT_EQ(a.complete, b.complete);
    EXPECT_EQ(a.missing_packets, b.missing_packets);
    EXPECT_EQ(a.clock.size(), b.clock.size());
  }
}

class Replay : public testing::TestWithParam<ReplayCase> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("CA2_TEST_DATA");
    if (data == nullptr) GTEST_SKIP() << "CA2_TEST_DATA is not set: the captures of others are not here";
    const auto folder = std::filesystem::path(data) / "packets";
    capture = folder / GetParam().capture;
    if (!std::filesystem::exists(capture)) GTEST_SKIP() << capture << " is not there";
    spec.model = GetParam().model;
    if (*GetParam().metadata != '\0') spec.metadata = folder / GetParam().metadata;
    PcapOptions options;
    options.ports = {GetParam().port};
    auto reader = PcapReader::open(capture, options);
    ASSERT_TRUE(reader);
    datagrams = read_all(**reader);

    Decoding decoding(spec);
    for (const KeptDatagram& d : datagrams) {
      decoding.push({d.time, d.source_address, d.source_port, d.destination_port, d.payload, d.truncated});
    }
    from_file = decoding.finish();
    ASSERT_EQ(from_file.size(), GetParam().scans);

    UdpSourceOptions source_options;
    source_options.ports = {0};
    source_options.socket.address = "127.0.0.1";
    source = std::move(*UdpSource::open(source_options));
  }

  std::uint16_t port() const { return source->sockets()[0].port; }

  /// Takes `count` datagrams from the socket.
  void receive(Decoding& decoding, std::size_t count) {
    while (count > 0) {
      const auto batch = source->next_batch(std::chrono::seconds(5));
      ASSERT_TRUE(batch && batch->event == PacketEvent::packets) << "datagrams are missing";
      for (const Datagram& datagram : batch->datagrams) decoding.push(datagram);
      count -= batch->datagrams.size();
    }
  }

  std::filesystem::path capture;
  LidarModelSpec spec;
  std::vector<KeptDatagram> datagrams;
  std::vector<LidarScan> from_file;
  std::unique_ptr<UdpSource> source;
};

TEST_P(Replay, InTimeOverTheLoopbackGivesTheSameScans) {
  using Clock = std::chrono::steady_clock;
  std::thread player([this] {
    auto sender = UdpSender::open("127.0.0.1");
    Pacer pacer(1);
    for (const KeptDatagram& datagram : datagrams) {
      const auto now = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch());
      std::this_thread::sleep_for(std::chrono::nanoseconds(pacer.wait(datagram.time, now.count())));
      EXPECT_TRUE(sender->send(port(), datagram.payload));
    }
  });
  Decoding decoding(spec);
  receive(decoding, datagrams.size());
  player.join();
  expect_same(decoding.finish(), from_file);
  EXPECT_EQ(source->counters().lost(), 0u);
}

TEST_P(Replay, AtFullSpeedOverTheLoopbackGivesTheSameScans) {
  auto sender = UdpSender::open("127.0.0.1");
  ASSERT_TRUE(sender);
  Decoding decoding(spec);
  constexpr std::size_t window = 8;  // as many as the smallest receive buffer holds of the largest packets
  for (std::size_t i = 0; i < datagrams.size(); i += window) {
    const std::size_t end = std::min(i + window, datagrams.size());
    for (std::size_t k = i; k < end; ++k) ASSERT_TRUE(sender->send(port(), datagrams[k].payload));
    receive(decoding, end - i);
  }
  expect_same(decoding.finish(), from_file);
}

INSTANTIATE_TEST_SUITE_P(
    All, Replay,
    testing::Values(ReplayCase{"OusterLowRate", "ouster/OS-0-128-U1_v2.3.0_1024x10.pcap", "",
                               "ouster/OS-0-128-U1_v2.3.0_1024x10.json", 7502, 1},
                    ReplayCase{"OusterCrc", "ouster/crc_test.pcap", "", "ouster/crc_test.json", 7502, 2},
                    ReplayCase{"VelodyneDual", "velodyne/nebula_VLP16_dual_1673400471837873222.pcap",
                               "VLP-16", "", 2368, 5},
                    ReplayCase{"VelodyneVls", "velodyne/nebula_VLS128_1614315746471294674.pcap", "VLS-128",
                               "", 2368, 5}),
    [](const auto& chosen) { return chosen.param.name; });

}  // namespace
}  // namespace ca2
