#include "drivers/net/pcap_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "drivers/net/pcap_reader.h"
#include "drivers/net/udp_frame.h"
#include "tests/drivers/net/frames.h"
#include "tests/drivers/net/read_all.h"

namespace ca2 {
namespace {

using namespace ca2::test;

class PcapWriterTest : public testing::Test {
 protected:
  PcapWriterTest() {
    char name[] = "/tmp/ca2_pcap_XXXXXX";
    directory_ = mkdtemp(name);
  }
  ~PcapWriterTest() override { std::filesystem::remove_all(directory_); }

  std::filesystem::path file() const { return directory_ / "out.pcap"; }

  std::filesystem::path directory_;
};

TEST_F(PcapWriterTest, ReadsBackWhatWasWritten) {
  std::mt19937_64 random(1);
  std::vector<KeptDatagram> written;
  const std::vector<std::string> sources{"192.0.2.7", "fe80::1234", "127.0.0.1", "2001:db8::7"};
  const std::vector<std::size_t> sizes{0, 1, 2, 48, 1206, 8448, 33024, 65507, 1473};
  for (std::size_t i = 0; i < 200; ++i) {
    KeptDatagram datagram;
    datagram.time = 1'700'000'000'000'000'000 + static_cast<std::int64_t>(random() % 5'000'000'000);
    datagram.source_address = sources[i % sources.size()];
    datagram.source_port = static_cast<std::uint16_t>(random());
    datagram.destination_port = static_cast<std::uint16_t>(random());
    datagram.payload = pattern(sizes[i % sizes.size()], static_cast<unsigned>(i));
    datagram.truncated = i % 11 == 5 && datagram.payload.size() < 65507;
    written.push_back(datagram);
  }
  auto writer = PcapWriter::create(file());
  ASSERT_TRUE(writer) << writer.error().text();
  for (const KeptDatagram& d : written) {
    const auto done =
        writer->write({d.time, d.source_address, d.source_port, d.destination_port, d.payload, d.truncated});
    ASSERT_TRUE(done) << done.error().text();
  }
  EXPECT_EQ(writer->datagrams(), 200u);
  ASSERT_TRUE(writer->close());
  EXPECT_EQ(writer->bytes(), std::filesystem::file_size(file()));
  auto reader = PcapReader::open(file());
  ASSERT_TRUE(reader);
  EXPECT_EQ(read_all(**reader), written);
  EXPECT_EQ((*reader)->counters().lost(), 0u);
  EXPECT_EQ((*reader)->counters().length_mismatches, 0u);
}

TEST_F(PcapWriterTest, KeepsWhatWasFlushedWhenTheProgramDies) {
  auto writer = PcapWriter::create(file());
  ASSERT_TRUE(writer);
  const Bytes payload = pattern(1206);
  for (std::int64_t i = 0; i < 100; ++i) {
    Datagram datagram;
    datagram.time = i * 100'000'000;  // a flush is due every tenth
    datagram.payload = payload;
    ASSERT_TRUE(writer->write(datagram));
  }
  // The file as another process sees it now, the writer still open: what a killed program leaves.
  auto reader = PcapReader::open(file());
  ASSERT_TRUE(reader);
  const auto all = read_all(**reader);
  EXPECT_GE(all.size(), 91u);
  for (const KeptDatagram& datagram : all) EXPECT_EQ(datagram.payload, payload);
}

TEST_F(PcapWriterTest, DoesNotOverwriteUnlessToldTo) {
  { ASSERT_TRUE(PcapWriter::create(file())); }
  const auto again = PcapWriter::create(file());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::cannot_create);
  PcapWriterOptions options;
  options.overwrite = true;
  EXPECT_TRUE(PcapWriter::create(file(), options));
  EXPECT_FALSE(PcapWriter::create(directory_ / "missing" / "out.pcap"));
}

TEST_F(PcapWriterTest, SaysThatTheDiskIsFull) {
  PcapWriterOptions options;
  options.overwrite = true;
  auto writer = PcapWriter::create("/dev/full", options);
  ASSERT_TRUE(writer) << writer.error().text();
  const auto done = writer->write({});
  ASSERT_FALSE(done) << "the first datagram is flushed";
  EXPECT_EQ(done.error().code, ErrorCode::io);
  EXPECT_NE(done.error().text().find("No space left"), std::string::npos) << done.error().text();
  EXPECT_FALSE(done.error().problems[0].hint.empty());
}

TEST_F(PcapWriterTest, RefusesWhatTheFormatCannotHold) {
  auto writer = PcapWriter::create(file());
  ASSERT_TRUE(writer);
  const Bytes large = pattern(65508);
  Datagram datagram;
  datagram.payload = large;
  EXPECT_EQ(writer->write(datagram).error().code, ErrorCode::data);
  datagram.payload = {};
  datagram.source_address = "lidar.local";
  EXPECT_EQ(writer->write(datagram).error().code, ErrorCode::data);
  datagram.source_address = "";
  for (const std::int64_t time : {std::int64_t{-1}, std::int64_t{1} << 62}) {
    datagram.time = time;
    EXPECT_EQ(writer->write(datagram).error().code, ErrorCode::data);
  }
  EXPECT_EQ(writer->datagrams(), 0u);
}

// The receiver's check of RFC 768 and 791: header and payload with their checksums sum to all ones.
TEST(UdpFrame, HasRightChecksums) {
  for (const char* address : {"192.0.2.7", "fe80::7"}) {
    for (const std::size_t size : {0, 1, 7, 1206, 33024}) {
      UdpEndpoints ends;
      ends.source = *parse_ip_address(address);
      ends.destination = *parse_ip_address(ends.source.v6 ? "ff02::1" : "255.255.255.255");
      ends.source_port = 2368;
      ends.destination_port = 2369;
      const Bytes payload = pattern(size);
      const UdpFrameHeaders headers = udp_frame_headers(ends, payload, 0, 7);
      const std::span<const std::uint8_t> all(headers.bytes.data(), headers.size);
      if (!ends.source.v6) {
        EXPECT_EQ(checksum_fold(checksum_add(0, all.subspan(14, 20))), 0);
      }
      const std::size_t addresses = ends.source.v6 ? 32 : 8;
      std::uint64_t sum = 17 + 8 + size;
      sum = checksum_add(sum, all.subspan(headers.size - 8 - addresses, addresses));
      sum = checksum_add(checksum_add(sum, all.last(8)), payload);
      EXPECT_EQ(checksum_fold(sum), 0);
    }
  }
}

// The worked example in RFC 1071, section 3.
TEST(UdpFrame, SumsAsTheRfcDoes) {
  const Bytes bytes{0x00, 0x01, 0xf2, 0x03, 0xf4, 0xf5, 0xf6, 0xf7};
  EXPECT_EQ(checksum_fold(checksum_add(0, bytes)), static_cast<std::uint16_t>(~0xddf2));
}

}  // namespace
}  // namespace ca2
