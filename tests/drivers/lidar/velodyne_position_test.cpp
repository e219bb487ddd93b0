#include "drivers/lidar/velodyne/position.h"

#include <gtest/gtest.h>

#include "test_data.h"

namespace ca2 {
namespace {

TEST(VelodynePosition, ARealOneSaysItsTimePlaceAndLock) {
  CA2_NEEDS_PACKETS(test::packet_file("velodyne/gadomski_VLP16_position.pcap"));
  const auto packets = test::read_packets(test::packet_file("velodyne/gadomski_VLP16_position.pcap"));
  ASSERT_EQ(packets.size(), 1u);
  const auto position = parse_velodyne_position(packets[0].bytes);
  ASSERT_TRUE(position);
  EXPECT_EQ(position->us_of_hour, 2467110195u);
  EXPECT_EQ(position->pps, VelodynePps::locked);
  EXPECT_TRUE(position->valid);
  EXPECT_NEAR(position->latitude, 37 + 7.8178 / 60, 1e-9);
  EXPECT_NEAR(position->longitude, -(121 + 39.2690 / 60), 1e-9);
  EXPECT_EQ(position->utc, 1'437'687'666'000'000'000);  // 2015-07-23 21:41:06
  // A sentence with a wrong digit is not believed.
  std::vector<std::uint8_t> damaged = packets[0].bytes;
  damaged[206 + 10] ^= 1;
  EXPECT_TRUE(parse_velodyne_position(damaged)->nmea.empty());
  damaged.pop_back();
  EXPECT_FALSE(parse_velodyne_position(damaged));
}

}  // namespace
}  // namespace ca2
