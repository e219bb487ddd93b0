#include "drivers/survey/survey.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "drivers/net/pcap_reader.h"

namespace ca2 {
namespace {

struct CaptureCase {
  const char* file;
  std::uint16_t port;
  std::size_t size;
  const char* vendor;
  const char* model;
  const char* kind;
  const char* detail = "";  ///< "key=value" that must be among the details
};

class SurveyCaptures : public testing::TestWithParam<CaptureCase> {};

/// A survey of a capture without every `drop`th datagram, or nothing when the captures are not here.
std::unique_ptr<Survey> survey_of(const char* name, std::uint64_t drop, std::uint64_t& dropped) {
  const char* data = std::getenv("CA2_TEST_DATA");
  if (data == nullptr) return nullptr;
  auto reader = PcapReader::open(std::filesystem::path(data) / "packets" / name);
  if (!reader) return nullptr;
  auto survey = std::make_unique<Survey>();
  std::uint64_t count = 0;
  for (;;) {
    const auto batch = (*reader)->next_batch();
    if (!batch || batch->event == PacketEvent::end) break;
    for (const Datagram& datagram : batch->datagrams) {
      if (datagram.payload.size() == 1206 && drop > 0 && ++count % drop == 0) {
        ++dropped;
        continue;
      }
      survey->add(datagram);
    }
  }
  return survey;
}

TEST_P(SurveyCaptures, AreNamed) {
  const CaptureCase& expected = GetParam();
  std::uint64_t dropped = 0;
  const auto survey = survey_of(expected.file, 0, dropped);
  if (!survey) GTEST_SKIP() << "CA2_TEST_DATA is not set, or has no such capture";
  bool found = false;
  for (const StreamSummary& stream : survey->streams()) {
    if (stream.destination_port != expected.port || stream.size != expected.size) continue;
    found = true;
    EXPECT_EQ(stream.identity.vendor, expected.vendor);
    EXPECT_EQ(stream.identity.model, expected.model);
    EXPECT_EQ(stream.identity.kind, expected.kind);
    EXPECT_EQ(stream.identity.lost.value_or(0), 0u);
    std::string details;
    for (const auto& [key, value] : stream.identity.details) details += key + "=" + value + ";";
    EXPECT_NE((";" + details).find(expected.detail), std::string::npos) << details;
  }
  EXPECT_TRUE(found);
}

INSTANTIATE_TEST_SUITE_P(
    All, SurveyCaptures,
    testing::Values(
        CaptureCase{"ouster/OS-1-32-G_v2.1.1_1024x10.pcap", 7502, 6464, "Ouster", "32 beams", "lidar",
                    "profile=LEGACY;columns=1024"},
        CaptureCase{"ouster/OS-1-64_1024x10_fw20.pcap", 7502, 12608, "Ouster", "64 beams", "lidar",
                    "profile=LEGACY"},
        CaptureCase{"ouster/OS-1-64_1024x10_fw20.pcap", 7503, 48, "Ouster", "", "IMU"},
        // 8448 bytes are several profiles with the same columns: the packets leave it open.
        CaptureCase{"ouster/OS-0-128-U1_v2.3.0_1024x10.pcap", 7502, 8448, "Ouster", "32 or 64 or 128 beams",
                    "lidar", "RNG15_RFL8_NIR8"},
        CaptureCase{"ouster/OS-1-128_767798045_1024x10_20230712_120049.pcap", 7502, 16640, "Ouster",
                    "64 or 128 beams", "lidar", "header=FUSA"},
        CaptureCase{"ouster/imu_zm_no_lidar.pcap", 7513, 452, "Ouster", "", "IMU", "serial="},
        CaptureCase{"ouster/imu_zm_no_lidar.pcap", 7514, 680, "Ouster", "", "zone"},
        CaptureCase{"ouster/VLI-16-one-packet.pcap", 2368, 1212, "", "", "unknown"},
        // 2014's firmware: it calls itself an HDL-32E.
        CaptureCase{"velodyne/VeloView_vlp-16-test-90deg-1-50-frames.pcap", 2368, 1206, "Velodyne", "VLP-16",
                    "lidar", "product_id=0x21"},
        CaptureCase{"velodyne/VeloView_vlp-16-test-90deg-1-50-frames.pcap", 8308, 512, "Velodyne", "",
                    "position", "pps="},
        CaptureCase{"velodyne/opendlv_HDL-32E_sampleShort.pcap", 2368, 1206, "Velodyne", "HDL-32E", "lidar"},
        CaptureCase{"velodyne/opendlv_HDL-64E_atwallshort.pcap", 2368, 1206, "Velodyne", "HDL-64E", "lidar"},
        CaptureCase{"velodyne/nebula_VLP16_dual_1673400471837873222.pcap", 2368, 1206, "Velodyne", "VLP-16",
                    "lidar", "returns=dual"},
        CaptureCase{"velodyne/nebula_VLS128_1614315746471294674.pcap", 2368, 1206, "Velodyne", "VLS-128",
                    "lidar", "returns=strongest"}),
    [](const auto& chosen) {
      std::string name =
          std::filesystem::path(chosen.param.file).stem().string() + "_" + std::to_string(chosen.param.size);
      for (char& letter : name) {
        if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
      }
      return name;
    });

TEST(Survey, CountsWhatAVelodyneLost) {
  for (const char* file : {"velodyne/VeloView_vlp-16-test-90deg-1-50-frames.pcap",
                           "velodyne/nebula_VLS128_1614315746471294674.pcap"}) {
    std::uint64_t dropped = 0;
    const auto survey = survey_of(file, 10, dropped);
    if (!survey) GTEST_SKIP() << "CA2_TEST_DATA is not set, or has no such capture";
    for (const StreamSummary& stream : survey->streams()) {
      if (stream.size != 1206) continue;
      ASSERT_TRUE(stream.identity.lost);
      EXPECT_NEAR(static_cast<double>(*stream.identity.lost), static_cast<double>(dropped), 1) << file;
      EXPECT_GT(dropped, 100u);
    }
  }
}

/// A LEGACY packet of 16 beams.
std::vector<std::uint8_t> legacy_packet(unsigned frame, unsigned first_column) {
  std::vector<std::uint8_t> packet(3392, 0);
  for (unsigned column = 0; column < 16; ++column) {
    const std::size_t at = column * 212u;
    packet[at + 8] = static_cast<std::uint8_t>(first_column + column);
    packet[at + 9] = static_cast<std::uint8_t>((first_column + column) >> 8);
    packet[at + 10] = static_cast<std::uint8_t>(frame);
  }
  return packet;
}

TEST(Survey, CountsWhatAnOusterLostWithAColumnWindow) {
  Survey survey;
  std::mt19937_64 random(8);
  std::uint64_t lost = 0, sent = 0;
  for (unsigned frame = 0; frame < 20; ++frame) {
    for (unsigned column = 128; column < 384; column += 16) {
      const bool inner = frame > 0 && frame < 19;
      if (inner && random() % 4 == 0) {
        ++lost;
        continue;
      }
      const auto packet = legacy_packet(frame, column);
      Datagram datagram;
      datagram.time = static_cast<std::int64_t>(frame) * 100'000'000 + column * 195'312;
      datagram.source_address = "192.0.2.7";
      datagram.destination_port = 7502;
      datagram.payload = packet;
      survey.add(datagram);
      ++sent;
    }
  }
  const auto streams = survey.streams();
  ASSERT_EQ(streams.size(), 1u);
  EXPECT_EQ(streams[0].datagrams, sent);
  EXPECT_EQ(streams[0].identity.lost, lost);
  EXPECT_EQ(streams[0].identity.model, "16 beams");
}

TEST(Survey, IsBoundedAndSurvivesAnyBytes) {
  Survey survey;
  std::mt19937_64 random(9);
  const std::size_t sizes[] = {48, 512, 1206, 308, 680, 3392, 8448, 16640, 24896};
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint8_t> payload(i % 3 == 0 ? random() % 2000 : sizes[random() % std::size(sizes)]);
    for (std::size_t k = 0; k < payload.size(); k += 3) payload[k] = static_cast<std::uint8_t>(random());
    Datagram datagram;
    datagram.time = static_cast<std::int64_t>(random());
    const std::string source = "192.0.2." + std::to_string(random() % 256);
    datagram.source_address = source;
    datagram.payload = payload;
    survey.add(datagram);
  }
  EXPECT_EQ(survey.streams().size(), 256u);
  EXPECT_GT(survey.unlisted(), 0u);
  for (const StreamSummary& stream : survey.streams()) EXPECT_GE(stream.rate(), 0);
}

}  // namespace
}  // namespace ca2
