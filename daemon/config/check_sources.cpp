#include "daemon/config/check_sources.h"

#include <array>

#include "daemon/sensors/lidar_spec.h"
#include "daemon/sensors/ouster_metadata.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/camera/option_reader.h"
#include "drivers/net/ip_address.h"

namespace ca2 {
namespace {

constexpr std::array<std::string_view, 6> lidar_options{"driver",  "host",  "port",
                                                        "address", "group", "interface"};
constexpr std::array<std::string_view, 2> lidar_drivers{"ouster", "velodyne"};
constexpr int ouster_port = 7502, velodyne_port = 2368;  // the vendors' defaults

}  // namespace

LidarAddress read_lidar_address(const std::string& name, const RigLidar& lidar,
                                std::vector<Problem>& problems) {
  OptionReader options(lidar.source, lidar_options);
  LidarAddress out;
  if (!lidar.source.count("driver")) options.problem("has no 'driver'", "ouster or velodyne");
  const std::string driver = options.choice("driver", lidar_drivers).value_or("");
  out.port = static_cast<std::uint16_t>(
      options.integer("port", 1, 65535).value_or(driver == "ouster" ? ouster_port : velodyne_port));
  const auto address = [&](std::string_view option) {
    const std::string text = options.text(option).value_or("");
    if (!text.empty() && !parse_ip_address(text)) {
      options.problem("'" + text + "' is no numeric address", "192.0.2.7, or fe80::1");
    }
    return text;
  };
  out.host = address("host");
  out.local_address = address("address");
  out.multicast_group = address("group");
  out.interface = options.text("interface").value_or("");
  if (const auto done = options.done(); !done) {
    for (const Problem& problem : done.error().problems) {
      problems.push_back({"lidar " + name + ": source", problem.what, problem.hint});
    }
  }
  return out;
}

std::filesystem::path resolve(const std::string& path, const std::filesystem::path& rig_file) {
  return path.empty() ? std::filesystem::path() : rig_file.parent_path() / path;
}

std::vector<Problem> check_sources(const Rig& rig, const std::filesystem::path& file) {
  std::vector<Problem> problems;
  if (const auto devices = camera_devices(rig.cameras); !devices) {
    problems = devices.error().problems;
  }
  for (const auto& [name, lidar] : rig.lidars) {
    const LidarAddress address = read_lidar_address(name, lidar, problems);
    if (asks_for_metadata(lidar)) continue;
    if (const auto driver = open_lidar_driver(lidar, file, address.host); !driver) {
      for (const Problem& problem : driver.error().problems) {
        problems.push_back({"lidar " + name + (problem.where.empty() ? "" : ": " + problem.where),
                            problem.what, problem.hint});
      }
    }
  }
  return problems;
}

}  // namespace ca2
