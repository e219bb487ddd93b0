#include <nlohmann/json.hpp>

#include "core/io/json.h"
#include "drivers/lidar/ouster/metadata.h"
#include "drivers/lidar_config/ouster_sections.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

/// An Ouster's answers, a line each: the configuration, then the sections.
std::vector<std::string> seeds() {
  return {R"({"lidar_mode": "512x10", "udp_profile_lidar": "LEGACY"})"
          "\n"
          R"({"prod_line": "OS-1-16", "prod_sn": "991900000001", "status": "RUNNING"})"
          "\n"
          R"({"beam_altitude_angles": [1, -1], "beam_azimuth_angles": [3, -3]})"
          "\nerror: Command not recognized.\n{}\n"
          R"({"pixels_per_column": 2, "columns_per_packet": 16, "columns_per_frame": 512})"};
}

}  // namespace ca2::fuzz

/// Whatever the sections are, they are put together as JSON that the reader of metadata can judge.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  const auto line = [&] {
    const std::string_view next = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(next.size() + 1, rest.size()));
    return std::string(next);
  };
  const std::string config = line();
  if (!parse_json(config).is_object()) return 0;  // refused before
  const auto metadata = assemble_ouster_metadata([&](const std::string&) { return line(); }, config);
  fuzz::require(metadata && nlohmann::json::accept(*metadata), "what was put together is no JSON");
  (void)parse_ouster_metadata(*metadata, "sensor");
  return 0;
}
