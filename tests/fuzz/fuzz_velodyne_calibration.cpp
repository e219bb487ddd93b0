#include "drivers/lidar/velodyne/velodyne_model.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  std::string xml =
      "<?xml version=\"1.0\"?><!DOCTYPE boost_serialization><boost_serialization><DB><distLSB_>0.2</distLSB_>"
      "<minIntensity_><count>2</count><item>0</item><item>9</item></minIntensity_><points_>";
  for (int id = 0; id < 2; ++id) {
    xml += "<item><px><id_>" + std::to_string(id) +
           "</id_><rotCorrection_>-5.3</rotCorrection_>"
           "<vertCorrection_>" +
           std::to_string(id - 0.5) +
           "</vertCorrection_><distCorrection_>111</distCorrection_>"
           "<focalSlope_>0</focalSlope_></px></item>";
  }
  xml += "</points_></DB></boost_serialization>";
  const VelodyneCalibration two = velodyne_factory_table({{-1, 0}, {1, 0}});
  return {
      write_velodyne_yaml(two), xml,
      "num_lasers: 2\nlasers: [{laser_id: 0, rot_correction: -0.1, max_intensity: 235}, {laser_id: 1}]\n"};
}

}  // namespace ca2::fuzz

/// XML or YAML; what is accepted is written as a YAML that gives the same table.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  using fuzz::require;
  const std::string text(reinterpret_cast<const char*>(data), size);
  constexpr int lasers = 2;
  const auto calibration = parse_velodyne_calibration(text, lasers, "input");
  if (!calibration) {
    require(!calibration.error().problems.empty(), "an error without a problem");
    return 0;
  }
  require(calibration->lasers.size() == lasers, "lasers");
  const auto again = parse_velodyne_yaml(write_velodyne_yaml(*calibration), lasers, "again");
  require(again && again->lasers == calibration->lasers, "the table changed");
  return 0;
}
