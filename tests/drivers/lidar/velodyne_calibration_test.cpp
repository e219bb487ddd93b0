#include "drivers/lidar/velodyne/calibration.h"

#include <gtest/gtest.h>

#include <numbers>

#include "drivers/lidar/model.h"
#include "drivers/lidar/velodyne/decoder.h"
#include "synthetic.h"
#include "test_data.h"

namespace ca2 {
namespace {

using test::packet_file;

VelodyneCalibration nominal() {
  return (*find_lidar_model("HDL-64E-nominal"))->velodyne()->factory;
}

TEST(VelodyneCalibration, RealFilesOfBothKinds) {
  CA2_NEEDS_PACKETS(packet_file("velodyne/opendlv_HDL-64E_db.xml"));
  const auto xml = read_velodyne_calibration(packet_file("velodyne/opendlv_HDL-64E_db.xml"), 64);
  ASSERT_TRUE(xml) << xml.error().text();
  constexpr double radian = std::numbers::pi / 180;
  EXPECT_NEAR(xml->lasers[0].rotation, -5.3328056 * radian, 1e-12);
  EXPECT_NEAR(xml->lasers[0].vertical, -7.2988362 * radian, 1e-12);
  EXPECT_NEAR(xml->lasers[0].distance, 1.11, 1e-12);
  EXPECT_NEAR(xml->lasers[2].vertical_offset, 0.20688799, 1e-12);
  EXPECT_NEAR(xml->lasers[3].horizontal_offset, -0.025999999, 1e-12);
  // 16 lasers, 64 entries in the file, of which the first count.
  EXPECT_TRUE(read_velodyne_calibration(packet_file("velodyne/VeloView_VLP-16.xml"), 16));
  EXPECT_TRUE(read_velodyne_calibration(packet_file("velodyne/opendlv_HDL-32E.xml"), 32));
  EXPECT_TRUE(read_velodyne_calibration(packet_file("velodyne/nebula_VLS128.yaml"), 128));
  for (const char* name : {"64e_s2.1-sztaki.yaml", "64e_utexas.yaml"}) {
    const auto yaml = read_velodyne_calibration(packet_file(std::string("../beams/") + name), 64);
    ASSERT_TRUE(yaml) << yaml.error().text();
    const auto again = parse_velodyne_calibration(write_velodyne_yaml(*yaml), 64, "written");
    ASSERT_TRUE(again) << again.error().text();
    EXPECT_EQ(again->lasers, yaml->lasers);
  }
  // The factory's table is what the drivers' file for it says.
  const auto vlp16 = read_velodyne_calibration(packet_file("../beams/VLP16db.yaml"), 16);
  ASSERT_TRUE(vlp16);
  const VelodyneCalibration& factory = (*find_lidar_model("VLP-16"))->velodyne()->factory;
  for (std::size_t id = 0; id < 16; ++id) {
    EXPECT_NEAR(vlp16->lasers[id].vertical, factory.lasers[id].vertical, 1e-9);
  }
}

TEST(VelodyneCalibration, WrongFilesAreRefusedWithWhatIsWrong) {
  const std::string good = write_velodyne_yaml(nominal());
  EXPECT_TRUE(parse_velodyne_calibration(good, 64, "f"));
  const auto other_model = parse_velodyne_calibration(good, 32, "f");
  ASSERT_FALSE(other_model);
  EXPECT_NE(other_model.error().text().find("laser_id from 0 to 31"), std::string::npos);
  const auto short_one = parse_velodyne_calibration("lasers:\n- {laser_id: 0}\n- {laser_id: 0}\n", 2, "f");
  ASSERT_FALSE(short_one);
  EXPECT_NE(short_one.error().text().find("f:3:3: laser 0 is listed twice"), std::string::npos)
      << short_one.error().text();
  EXPECT_NE(short_one.error().text().find("1 of the 2 lasers"), std::string::npos);
  const auto no_number =
      parse_velodyne_calibration("lasers:\n- {laser_id: 0, rot_correction: north}\n", 1, "f");
  ASSERT_FALSE(no_number);
  EXPECT_NE(no_number.error().text().find("rot_correction"), std::string::npos);
  for (const char* text :
       {"", "lasers: 3", "[", "<a", "<a/>", "<boost_serialization><DB/></boost_serialization>", "- 1\n- 2\n",
        "lasers: [{laser_id: .nan}]"}) {
    EXPECT_FALSE(parse_velodyne_calibration(text, 16, "f")) << text;
  }
}

TEST(VelodyneCalibration, StreamedTableSurvivesTheWire) {
  const VelodyneCalibration sent = nominal();
  const std::vector<std::uint8_t> table = write_streamed_calibration(sent);
  const auto read = parse_streamed_calibration(table);
  ASSERT_TRUE(read);
  for (std::size_t id = 0; id < 64; ++id) {
    EXPECT_NEAR(read->lasers[id].vertical, sent.lasers[id].vertical, 0.0051 * std::numbers::pi / 180);
    EXPECT_NEAR(read->lasers[id].rotation, sent.lasers[id].rotation, 0.0051 * std::numbers::pi / 180);
    EXPECT_NEAR(read->lasers[id].distance, sent.lasers[id].distance, 0.00051);
    EXPECT_NEAR(read->lasers[id].horizontal_offset, sent.lasers[id].horizontal_offset, 0.00051);
  }
  for (const std::size_t at : {std::size_t{9}, std::size_t{690}, table.size() - 1}) {
    std::vector<std::uint8_t> damaged = table;
    damaged[at] ^= 1;
    EXPECT_FALSE(parse_streamed_calibration(damaged)) << at;
  }
  std::vector<std::uint8_t> s2 = table;
  s2[s2.size() - 2] = 1820 & 0xFF;
  s2[s2.size() - 1] = 1820 >> 8;
  EXPECT_TRUE(parse_streamed_calibration(s2));
}

TEST(VelodyneCalibration, AnHdl64eIsDecodedOnceItsStreamHasItsTable) {
  const VelodyneModel& model = *(*find_lidar_model("HDL-64E"))->velodyne();
  const VelodyneCalibration calibration = nominal();
  const std::vector<std::uint8_t> table = write_streamed_calibration(calibration);
  VelodyneEncoder encoder(model, calibration, {});
  const int columns = static_cast<int>(0.1 / model.cycle);
  std::mt19937_64 random(5);
  std::vector<EncodedPacket> packets;
  for (int i = 0; i < 20; ++i) {
    EncoderScan scan = test::random_scan(64, columns, 0.002, false, random);
    scan.start = 1'700'000'000'000'000'000 + i * 100'000'000ll;
    for (EncodedPacket& packet : encoder.push(scan)) packets.push_back(std::move(packet));
  }
  // Nine status values, then seven bytes of the table; it starts in the middle.
  constexpr char status[] = "HMSDNYGTV";
  std::size_t next = 900;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const bool is_status = i % 16 < 9;
    packets[i].bytes[1204] = static_cast<std::uint8_t>(is_status ? status[i % 16] : 'W');
    packets[i].bytes[1205] = is_status ? std::uint8_t{7} : table[next++ % table.size()];
  }
  VelodyneDecoder decoder(model, std::nullopt, {});
  EXPECT_FALSE(decoder.ready());
  LidarCounters counters;
  const auto first = test::decode_packets(decoder, packets, counters);
  ASSERT_TRUE(decoder.ready());
  EXPECT_EQ(counters.waiting_for_calibration + counters.lidar_packets, packets.size());
  EXPECT_GT(counters.waiting_for_calibration, 4160u / 2);
  EXPECT_FALSE(first.empty());
  // A lost packet leaves a hole in the table: no calibration is made of it.
  VelodyneDecoder holed(model, std::nullopt, {});
  packets.erase(packets.begin() + 3500);
  test::decode_packets(holed, packets, counters);
  EXPECT_FALSE(holed.ready());
}

}  // namespace
}  // namespace ca2
