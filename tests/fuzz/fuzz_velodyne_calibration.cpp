#include "drivers/lidar/model.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  std::string xml =
      "<?xml version=\"1.0\"?><!DOCTYPE boost_serialization><boost_serialization><DB><distLSB_>0.2</distLSB_>"
      "<minIntensity_><count>2</count><item>0</item><item>9</item></minIntensity_><points_>";
  for (int id = 0; id < 16; ++id) {
    xml += "<item><px><id_>" + std::to_string(id) +
           "</id_><rotCorrection_>-5.3</rotCorrection_>"
           "<vertCorrection_>" +
           std::to_string(id - 7.5) +
           "</vertCorrection_><distCorrection_>111</distCorrection_>"
           "<focalSlope_>0</focalSlope_></px></item>";
  }
  xml += "</points_></DB></boost_serialization>";
  return {write_velodyne_yaml((*find_lidar_model("VLP-16"))->velodyne()->factory), xml,
          "num_lasers: 1\nlasers: [{laser_id: 0, rot_correction: -0.1, max_intensity: 235}]\n"};
}

}  // namespace ca2::fuzz

/// XML or YAML; what is accepted is written as a YAML that gives the same table.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  using fuzz::require;
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const int lasers : {1, 16}) {
    const auto calibration = parse_velodyne_calibration(text, lasers, "input");
    if (!calibration) {
      require(!calibration.error().problems.empty(), "an error without a problem");
      continue;
    }
    require(calibration->lasers.size() == static_cast<std::size_t>(lasers), "lasers");
    const auto again = parse_velodyne_yaml(write_velodyne_yaml(*calibration), lasers, "again");
    require(again && again->lasers == calibration->lasers, "the table changed");
  }
  return 0;
}
