#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/decoder.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  OusterModel model = *(*find_lidar_model("OS1-16"))->ouster();
  model.beams = 2;
  std::vector<std::string> out{
      write_ouster_metadata(nominal_ouster_metadata(model, 512, 10, "RNG15_RFL8_NIR8_DUAL")),
      R"({"lidar_mode": "512x10", "beam_altitude_angles": [1, -1], "beam_azimuth_angles": [3, -3],
          "data_format": {"pixels_per_column": 2, "columns_per_packet": 16, "columns_per_frame": 512,
          "column_window": [500, 3], "pixel_shift_by_row": [4, -4]}, "prod_sn": 991900000001,
          "lidar_origin_to_beam_origin_mm": 15.8, "initialization_id": 7})"};
  return out;
}

}  // namespace ca2::fuzz

/// What is accepted is written as a text that says the same, and decoders can be made of it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  using fuzz::require;
  const auto metadata =
      parse_ouster_metadata(std::string(reinterpret_cast<const char*>(data), size), "input");
  if (!metadata) {
    require(!metadata.error().problems.empty(), "an error without a problem");
    return 0;
  }
  require(metadata->altitude.size() == static_cast<std::size_t>(metadata->pixels_per_column), "angles");
  require(metadata->valid_columns() > 0 && metadata->valid_columns() <= metadata->columns_per_frame,
          "window");
  if (metadata->columns_per_frame <= 64 && metadata->profile != "OFF") OusterDecoder decoder(*metadata);
  const std::string text = write_ouster_metadata(*metadata);
  const auto again = parse_ouster_metadata(text, "again");
  require(again.has_value(), "what was written cannot be read");
  return 0;
}
