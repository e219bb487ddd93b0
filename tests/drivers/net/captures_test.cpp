/// @file Real captures: what their manifest says of them. Velodyne's come with inconsistent IP lengths, cut
/// last records and a day-old fragment id; Ouster's as pseudo-jumbo frames and as fragments.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "drivers/net/pcap_reader.h"
#include "tests/drivers/net/read_all.h"

namespace ca2 {
namespace {

using namespace ca2::test;

/// Datagrams by (destination port, payload size).
using Histogram = std::map<std::pair<int, std::size_t>, int>;

struct CaptureCase {
  const char* file;
  Histogram expected;
  std::uint64_t reassembled = 0, incomplete = 0, cut_records = 0, length_mismatches = 0;
};

class Captures : public testing::TestWithParam<CaptureCase> {};

TEST_P(Captures, HoldTheDatagramsOfTheManifest) {
  const char* data = std::getenv("CA2_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "CA2_TEST_DATA is not set: the captures of others are not here";
  const auto file = std::filesystem::path(data) / "packets" / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  auto reader = PcapReader::open(file);
  ASSERT_TRUE(reader) << reader.error().text();
  Histogram seen;
  for (const KeptDatagram& datagram : read_all(**reader)) {
    ++seen[{datagram.destination_port, datagram.payload.size()}];
    EXPECT_FALSE(datagram.truncated);
    EXPECT_FALSE(datagram.source_address.empty());
  }
  EXPECT_EQ(seen, GetParam().expected);
  const PacketCounters& counters = (*reader)->counters();
  EXPECT_EQ(counters.reassembled, GetParam().reassembled);
  EXPECT_EQ(counters.incomplete, GetParam().incomplete);
  EXPECT_EQ(counters.cut_records, GetParam().cut_records);
  EXPECT_EQ(counters.length_mismatches, GetParam().length_mismatches);
  EXPECT_EQ(counters.lost(), counters.incomplete + counters.cut_records);
}

INSTANTIATE_TEST_SUITE_P(
    All, Captures,
    testing::Values(
        CaptureCase{"ouster/OS-0-128-U1_v2.3.0_1024x10.pcap", {{{7502, 8448}, 64}, {{7503, 48}, 10}}},
        CaptureCase{"ouster/OS-1-128_767798045_1024x10_20230712_120049.pcap",
                    {{{7502, 16640}, 8}, {{7503, 48}, 2}}},
        CaptureCase{"ouster/OS-1-64_1024x10_fw20.pcap", {{{7502, 12608}, 64}, {{7503, 48}, 11}}},
        CaptureCase{"ouster/same_ports.pcap", {{{7502, 48}, 2}, {{7502, 12608}, 1}, {{7502, 16640}, 1}}, 2},
        CaptureCase{"ouster/same_ports_legacy.pcap", {{{7502, 12608}, 1}, {{7502, 24896}, 1}}, 2},
        // The first fragment is of a datagram 88 s earlier, whose id came round again.
        CaptureCase{"ouster/duplicate_id.pcap", {{{34636, 8448}, 1}}, 1, 1},
        CaptureCase{"ouster/imu_zm_no_lidar.pcap", {{{7513, 452}, 8}, {{7514, 680}, 1}}},
        CaptureCase{"ouster/empty_pcap.pcap", {}},
        CaptureCase{"velodyne/VeloView_vlp-16-test-90deg-1-50-frames.pcap",
                    {{{2368, 1206}, 1902}, {{8308, 512}, 367}},
                    0,
                    0,
                    0,
                    367},
        CaptureCase{
            "velodyne/opendlv_HDL-32E_sampleShort.pcap", {{{2368, 1206}, 603}, {{8308, 512}, 65}}, 0, 0, 1},
        CaptureCase{"velodyne/opendlv_HDL-64E_atwallshort.pcap", {{{2368, 1206}, 306}}, 0, 0, 1},
        CaptureCase{"velodyne/nebula_VLS128_1614315746471294674.pcap", {{{2368, 1206}, 2193}}},
        CaptureCase{
            "velodyne/rust_velodyne_vlp16.pcap", {{{2368, 1206}, 84}, {{8308, 512}, 16}}, 0, 0, 0, 16}),
    [](const auto& chosen) {
      std::string name = std::filesystem::path(chosen.param.file).stem();
      for (char& letter : name) {
        if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
      }
      return name;
    });

}  // namespace
}  // namespace ca2
