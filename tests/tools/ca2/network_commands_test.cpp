/// @file sensors, record and play as a person runs them; traffic stays on the loopback.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/net/pcap_reader.h"
#include "drivers/net/pcap_writer.h"
#include "drivers/net/udp_socket.h"
#include "tests/tools/ca2/program.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
using namespace std::chrono_literals;
using nlohmann::json;
using Payloads = std::vector<std::vector<std::uint8_t>>;

/// A VLP-16's packets, 1327 us apart.
Payloads packets(std::size_t count) {
  Payloads all;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::uint8_t> packet(1206, static_cast<std::uint8_t>(i));
    for (std::size_t block = 0; block < 12; ++block) {
      packet[block * 100] = 0xff;
      packet[block * 100 + 1] = 0xee;
      packet[block * 100 + 3] = 0x10;
    }
    const auto stamp = static_cast<std::uint32_t>(1'000'000 + 1327 * i);
    for (std::size_t k = 0; k < 4; ++k) packet[1200 + k] = static_cast<std::uint8_t>(stamp >> (8 * k));
    packet[1204] = 0x37;
    packet[1205] = 0x22;
    all.push_back(std::move(packet));
  }
  return all;
}

class NetworkCommands : public testing::Test {
 protected:
  NetworkCommands() {
    char name[] = "/tmp/ca2_net_XXXXXX";
    directory_ = mkdtemp(name);
    auto writer = PcapWriter::create(capture());
    std::int64_t time = 1'700'000'000'000'000'000;
    for (const auto& payload : packets(300)) {
      Datagram datagram;
      datagram.time = time += 1'327'000;
      datagram.source_address = "192.0.2.7";
      datagram.source_port = datagram.destination_port = 2368;
      datagram.payload = payload;
      EXPECT_TRUE(writer->write(datagram));
    }
    EXPECT_TRUE(writer->close());
  }
  ~NetworkCommands() override { std::filesystem::remove_all(directory_); }

  std::string capture() const { return directory_ / "capture.pcap"; }
  std::string recorded() const { return directory_ / "recorded.pcap"; }

  std::filesystem::path directory_;
};

std::uint16_t free_port() {
  UdpSocketOptions options;
  options.address = "127.0.0.1";
  return open_udp_socket(options)->port;
}

/// Until another program has the port.
bool wait_until_taken(std::uint16_t port) {
  UdpSocketOptions options;
  options.address = "127.0.0.1";
  options.port = port;
  for (int i = 0; i < 1000; ++i) {
    if (!open_udp_socket(options)) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

Payloads payloads_of(const std::string& file) {
  Payloads all;
  auto reader = PcapReader::open(file);
  EXPECT_TRUE(reader) << reader.error().text();
  if (!reader) return all;
  for (;;) {
    const auto batch = (*reader)->next_batch();
    if (!batch || batch->event != PacketEvent::packets) return all;
    for (const Datagram& d : batch->datagrams) all.emplace_back(d.payload.begin(), d.payload.end());
  }
}

/// What tcpdump keeps of a little-endian capture when it is told to keep so many bytes of a packet.
std::string with_capture_length(const std::string& capture, std::uint32_t most) {
  constexpr std::size_t file_header = 24, record_header = 16;
  std::string cut = capture.substr(0, file_header);
  for (std::size_t at = file_header; at < capture.size();) {
    std::string header = capture.substr(at, record_header);
    std::uint32_t size = 0;
    std::memcpy(&size, &header[8], sizeof size);
    const std::uint32_t kept = std::min(size, most);
    std::memcpy(&header[8], &kept, sizeof kept);
    cut += header + capture.substr(at + record_header, kept);
    at += record_header + size;
  }
  return cut;
}

TEST_F(NetworkCommands, PacketsThatWereCutByTheirRecordingAreTold) {
  test::write_bytes(recorded(), with_capture_length(test::bytes_of(capture()), 96));
  const std::string what = recorded() +
                           ": warning: of 300 packets only the beginning was recorded; `ca2 record packets` "
                           "records whole ones, and so does `tcpdump -s 0`";
  const Outcome seen = run_ca2({"sensors", "--pcap", recorded()});
  EXPECT_EQ(seen.status, 0);
  EXPECT_NE(seen.errors.find(what), std::string::npos) << seen.errors;
  EXPECT_NE(seen.output.find("192.0.2.7 -> port 2368: cut short by its recording"), std::string::npos)
      << seen.output;
  const json report = json::parse(run_ca2({"sensors", "--pcap", recorded(), "--json"}).output);
  EXPECT_EQ(report["streams"].at(0)["cut"], true);
  EXPECT_EQ(report["warnings"].size(), 1u);
  const Outcome decoded =
      run_ca2({"decode", recorded(), "--model", "VLP-16", "--output", directory_ / "points"});
  EXPECT_EQ(decoded.status, 65);
  EXPECT_NE(decoded.errors.find("of 300 packets only the beginning was recorded"), std::string::npos)
      << decoded.errors;
}

TEST_F(NetworkCommands, ACaptureWithoutDatagramsIsNoNetworkWithoutSensors) {
  test::write_bytes(recorded(), test::bytes_of(capture()).substr(0, 24));
  const Outcome empty = run_ca2({"sensors", "--pcap", recorded()});
  EXPECT_EQ(empty.status, 65);
  EXPECT_NE(empty.errors.find("has no datagrams"), std::string::npos) << empty.errors;
}

TEST_F(NetworkCommands, SensorsNamesWhatACaptureHolds) {
  const Outcome run = run_ca2({"sensors", "--pcap", capture(), "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const json report = json::parse(run.output);
  ASSERT_EQ(report["streams"].size(), 1u);
  const json& stream = report["streams"][0];
  EXPECT_EQ(stream["vendor"], "Velodyne");
  EXPECT_EQ(stream["model"], "VLP-16");
  EXPECT_EQ(stream["source"], "192.0.2.7");
  EXPECT_EQ(stream["datagrams"], 300);
  EXPECT_EQ(stream["lost"], 0);
  EXPECT_NEAR(stream["rate_hz"].get<double>(), 753.6, 1);
  const Outcome words = run_ca2({"sensors", "--pcap", capture()});
  EXPECT_NE(words.output.find("Velodyne VLP-16 lidar"), std::string::npos) << words.output;
}

TEST_F(NetworkCommands, RecordsWhatIsPlayedAndEndsCleanlyOnCtrlC) {
  const std::uint16_t port = free_port();
  Program record({"record", "packets", "--address", "127.0.0.1", "--port", std::to_string(port), "--output",
                  recorded(), "--json"});
  ASSERT_TRUE(wait_until_taken(port));
  const auto start = std::chrono::steady_clock::now();
  const Outcome play =
      run_ca2({"play", capture(), "--to", "127.0.0.1:" + std::to_string(port), "--speed", "2"});
  const auto took = std::chrono::steady_clock::now() - start;
  ASSERT_EQ(play.status, 0) << play.errors;
  EXPECT_GE(took, 190ms) << "0.4 s of packets at twice the speed";
  record.interrupt();
  ASSERT_EQ(record.wait(), 0) << record.errors();
  const json report = json::parse(record.output());
  EXPECT_EQ(report["counters"]["datagrams"], 300);
  EXPECT_EQ(report["counters"]["lost"], 0);
  EXPECT_EQ(report["file_bytes"], std::filesystem::file_size(recorded()));
  EXPECT_EQ(payloads_of(recorded()), packets(300));
}

TEST_F(NetworkCommands, RecordsAFilePerPortIntoADirectory) {
  const std::uint16_t port = free_port();
  const auto folder = directory_ / "recording";
  Program record({"record", "packets", "--address", "127.0.0.1", "--port", std::to_string(port), "--output",
                  folder, "--duration", "30"});
  ASSERT_TRUE(wait_until_taken(port));
  ASSERT_EQ(run_ca2({"play", capture(), "--to", "127.0.0.1:" + std::to_string(port)}).status, 0);
  record.interrupt();
  ASSERT_EQ(record.wait(), 0) << record.errors();
  EXPECT_EQ(payloads_of(folder / ("udp-" + std::to_string(port) + ".pcap")), packets(300));
}

TEST_F(NetworkCommands, EndWithTheStatusThatSaysWhatWentWrong) {
  const std::string port = std::to_string(free_port());
  EXPECT_EQ(run_ca2({"sensors", "--port", port, "--duration", "0.05"}).status, 69) << "nothing heard";
  EXPECT_EQ(run_ca2({"sensors", "--pcap", "/nonexistent.pcap"}).status, 74);
  EXPECT_EQ(run_ca2({"record", "packets", "--port", port, "--output", capture()}).status, 73) << "exists";
  EXPECT_EQ(
      run_ca2({"record", "packets", "--port", port, "--output", recorded(), "--duration", "0.05"}).status,
      69);
  EXPECT_EQ(run_ca2({"record"}).status, 64);
  EXPECT_EQ(run_ca2({"play", capture(), "--to", "127.0.0.1:x"}).status, 64);
  EXPECT_EQ(run_ca2({"play", "/proc/self/exe", "--to", "127.0.0.1"}).status, 65) << "no capture";
  const Outcome taken = [&] {
    UdpSocketOptions options;
    const auto holder = open_udp_socket(options);
    return run_ca2({"record", "packets", "--port", std::to_string(holder->port), "--output", recorded()});
  }();
  EXPECT_EQ(taken.status, 69);
  EXPECT_NE(taken.errors.find("in use"), std::string::npos) << taken.errors;
}

}  // namespace
}  // namespace ca2
