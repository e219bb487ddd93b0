// Real recordings against what VeloView and nebula made of them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "core/io/files.h"
#include "test_data.h"

namespace ca2 {
namespace {

using test::decode;
using test::packet_file;

std::vector<LidarScan> decode_file(const std::string& pcap, const LidarModelSpec& spec,
                                   LidarCounters* counters = nullptr,
                                   const LidarDriverOptions& options = {}) {
  auto driver = LidarDriver::open(spec, options);
  EXPECT_TRUE(driver) << (driver ? "" : driver.error().text());
  if (!driver) return {};
  auto scans = decode(*driver, test::read_packets(packet_file("velodyne/" + pcap)));
  if (counters) *counters = driver->counters();
  return scans;
}

/// What `ca2 decode` does by default.
LidarDriverOptions as_published() {
  LidarDriverOptions options;
  options.exact = true;
  options.azimuth = VelodyneAzimuth::published;
  return options;
}

TEST(VelodyneGolden, Vlp16OfVeloViewsOwnTest) {
  const std::string pcap = "VeloView_vlp-16-test-90deg-1-50-frames.pcap";
  CA2_NEEDS_PACKETS(packet_file("velodyne/" + pcap));
  LidarCounters counters;
  const LidarModelSpec spec{"VLP-16", {}, packet_file("velodyne/VeloView_VLP-16.xml"), 0, 0};
  const auto scans = decode_file(pcap, spec, &counters, as_published());
  EXPECT_EQ(counters.lidar_packets, 1902u);  // although they call themselves an HDL-32E
  EXPECT_EQ(counters.position_packets, 367u);
  EXPECT_EQ(counters.missing_packets, 0u);
  ASSERT_EQ(scans.size(), 52u);
  EXPECT_EQ(scans[0].scan.size(), 5736u);
  EXPECT_EQ(scans[2].scan.size(), 13898u);
  EXPECT_EQ(scans[16].scan.size(), 13860u);
  EXPECT_EQ(scans[51].scan.size(), 274u);
  EXPECT_FALSE(scans[0].complete);
  EXPECT_TRUE(scans[1].complete);
  EXPECT_FALSE(scans[51].complete);
  // VeloView lists channels in the order of the packet, as we do.
  const Scan& scan = scans[16].scan;
  const Eigen::Vector3d first(0.0801272, 6.04037, -1.61865), last(-0.0094354, 4.91462, 1.31687);
  EXPECT_LT((scan.points[0].cast<double>() - first).norm(), 1e-5);
  EXPECT_LT((scan.points[13859].cast<double>() - last).norm(), 1e-5);
  // Unrounded, for calibration.
  const auto unrounded = decode_file(pcap, spec);
  EXPECT_LT((unrounded.at(16).scan.points[0].cast<double>() - first).norm(), 1e-3);
  EXPECT_EQ(scan.intensity[0], 4);
  EXPECT_EQ(scan.intensity[13859], 29);
}

/// A VeloView CSV inside a zip: x, y, z, intensity.
std::vector<Eigen::Vector4d> read_zipped_csv(const std::filesystem::path& zip) {
  std::vector<Eigen::Vector4d> rows;
  FILE* pipe = popen(("unzip -p '" + zip.string() + "' 2>/dev/null").c_str(), "r");
  if (!pipe) return rows;
  char line[512];
  while (std::fgets(line, sizeof line, pipe)) {
    Eigen::Vector4d row;
    if (std::sscanf(line, "%lf,%lf,%lf,%lf", &row[0], &row[1], &row[2], &row[3]) == 4) rows.push_back(row);
  }
  pclose(pipe);
  return rows;
}

TEST(VelodyneGolden, Hdl64eS1PointByPoint) {
  const std::string pcap = "opendlv_HDL-64E_atwallshort.pcap";
  CA2_NEEDS_PACKETS(packet_file("velodyne/" + pcap));
  LidarCounters counters;
  const LidarModelSpec spec{"HDL-64E", {}, packet_file("velodyne/opendlv_HDL-64E_db.xml"), 0, 0};
  const auto scans = decode_file(pcap, spec, &counters, as_published());
  EXPECT_EQ(counters.lidar_packets, 306u);
  EXPECT_EQ(counters.wrong_size, 0u);  // the truncated record at the end never gets here
  ASSERT_GE(scans.size(), 2u);
  const auto expected = read_zipped_csv(packet_file("velodyne/opendlv_HDL-64E_atwallFrame1New_csv.zip"));
  if (expected.empty()) GTEST_SKIP() << "unzip is not installed";
  ASSERT_EQ(expected.size(), 89105u);
  const Scan& scan = scans[1].scan;
  ASSERT_EQ(scan.size(), expected.size());
  double worst = 0, worst_single = 0;
  int intensities = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Eigen::Vector3d& exact = scans[1].exact[i].point;
    worst = std::max(worst, (exact - expected[i].head<3>()).norm());
    worst_single = std::max(worst_single, (exact - scan.points[i].cast<double>()).norm() / scan.range[i]);
    intensities += scan.intensity[i] == expected[i][3];
  }
  EXPECT_LT(worst, 10e-6);
  EXPECT_LT(worst_single, 4e-7);
  EXPECT_EQ(intensities, 89105);
}

TEST(VelodyneGolden, Hdl32ePointByPoint) {
  const std::string pcap = "opendlv_HDL-32E_sampleShort.pcap";
  CA2_NEEDS_PACKETS(packet_file("velodyne/" + pcap));
  LidarCounters counters;
  const LidarModelSpec spec{"HDL-32E", {}, packet_file("velodyne/opendlv_HDL-32E.xml"), 0, 0};
  const auto scans = decode_file(pcap, spec, &counters, as_published());
  EXPECT_EQ(counters.lidar_packets, 603u);
  EXPECT_EQ(counters.position_packets, 65u);
  EXPECT_EQ(counters.wrong_size, 0u);  // the truncated record at the end never gets here
  ASSERT_EQ(scans.size(), 4u);
  const auto expected = read_zipped_csv(packet_file("velodyne/opendlv_HDL-32E_VeloViewFrame1_csv.zip"));
  if (expected.empty()) GTEST_SKIP() << "unzip is not installed";
  ASSERT_EQ(expected.size(), 47962u);
  const Scan& scan = scans[1].scan;
  ASSERT_EQ(scan.size(), expected.size());
  const auto unrounded = decode_file(pcap, spec);
  ASSERT_EQ(unrounded.at(1).scan.size(), expected.size());
  // An azimuth that lies half-way between two steps of 0.01 degree is rounded up here; VeloView's falls to
  // either side by its times' last bits.
  int intensities = 0, equal = 0;
  double worst = 0, worst_unrounded = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Eigen::Vector3d reference = expected[i].head<3>();
    const double error = (scans[1].exact[i].point - reference).norm();
    worst = std::max(worst, error);
    equal += error < 20e-6;
    const double beside = (unrounded[1].scan.points[i].cast<double>() - reference).norm();
    worst_unrounded = std::max(worst_unrounded, beside / (scan.range[i] * std::numbers::pi / 18000));
    intensities += scan.intensity[i] == expected[i][3];
  }
  EXPECT_LT(worst, 6e-3);
  EXPECT_GE(equal, 45'700);
  EXPECT_LT(worst_unrounded, 1.0) << "steps of 0.01 degree";
  EXPECT_EQ(intensities, 47962);
}

/// How many points of a reference cloud (ROS frame) a sequence of our scans has within `tolerance`.
struct Matched {
  std::size_t reference = 0, matched = 0;
};
Matched match(const std::vector<LidarScan>& scans, const std::filesystem::path& pcd, double tolerance) {
  const Result<Scan> reference = read_pcd(pcd);
  EXPECT_TRUE(reference);
  if (!reference) return {};
  using Cell = std::array<int, 3>;
  const double edge = 2 * tolerance;
  const auto cell = [&](const Eigen::Vector3f& p) {
    return Cell{static_cast<int>(std::floor(p.x() / edge)), static_cast<int>(std::floor(p.y() / edge)),
                static_cast<int>(std::floor(p.z() / edge))};
  };
  std::map<Cell, std::vector<Eigen::Vector3f>> ours;
  for (const LidarScan& scan : scans) {
    for (const Eigen::Vector3f& p : scan.scan.points) {
      const Eigen::Vector3f ros(p.y(), -p.x(), p.z());
      ours[cell(ros)].push_back(ros);
    }
  }
  Matched out;
  out.reference = reference->size();
  for (const Eigen::Vector3f& p : reference->points) {
    const Cell c = cell(p);
    bool found = false;
    for (int i = 0; i < 27 && !found; ++i) {
      const auto near = ours.find({c[0] + i % 3 - 1, c[1] + i / 3 % 3 - 1, c[2] + i / 9 - 1});
      if (near == ours.end()) continue;
      for (const Eigen::Vector3f& q : near->second) found = found || (q - p).norm() <= tolerance;
    }
    out.matched += found;
  }
  return out;
}

TEST(VelodyneGolden, Vls128AgainstNebula) {
  const std::string pcap = "nebula_VLS128_1614315746471294674.pcap";
  CA2_NEEDS_PACKETS(packet_file("velodyne/" + pcap));
  const LidarModelSpec spec{"VLS-128", {}, packet_file("velodyne/nebula_VLS128.yaml"), 0, 0};
  const auto scans = decode_file(pcap, spec, nullptr, as_published());
  const Matched m = match(scans, packet_file("velodyne/nebula_VLS128_1585897255376374245.pcd"), 0.021);
  EXPECT_EQ(m.reference, 208680u);
  EXPECT_GE(m.matched, 208679u);
}

TEST(VelodyneGolden, Vlp16DualAgainstNebula) {
  const std::string pcap = "nebula_VLP16_dual_1673400471837873222.pcap";
  CA2_NEEDS_PACKETS(packet_file("velodyne/" + pcap));
  LidarCounters counters;
  const LidarModelSpec spec{"VLP-16", {}, packet_file("velodyne/nebula_VLP16.yaml"), 0, 0};
  const auto scans = decode_file(pcap, spec, &counters, as_published());
  EXPECT_EQ(counters.lidar_packets, 603u);
  const Matched m = match(scans, packet_file("velodyne/nebula_VLP16_dual_1673400472138016708.pcd"), 0.021);
  EXPECT_EQ(m.reference, 14831u);
  EXPECT_EQ(m.matched, 14831u);
}

TEST(VelodyneGolden, SmallCaptures) {
  CA2_NEEDS_PACKETS(packet_file("velodyne/gadomski_VLP16_single.pcap"));
  const auto single = decode_file("gadomski_VLP16_single.pcap", {"VLP-16", {}, {}, 0, 0});
  ASSERT_EQ(single.size(), 1u);
  EXPECT_EQ(single[0].clock[0].device % 3'600'000'000'000, 2'467'108'343'000);
  LidarCounters counters;
  const auto rust = decode_file("rust_velodyne_vlp16.pcap", {"VLP-16", {}, {}, 0, 0}, &counters);
  EXPECT_EQ(counters.lidar_packets, 84u);
  EXPECT_EQ(counters.position_packets, 16u);
  EXPECT_FALSE(rust.empty());
}

}  // namespace
}  // namespace ca2
