// The board in a scan: ours, and the point cloud library's Euclidean clusters with a RANSAC plane in each, on
// the scans of `ca2 bench lidar` in one run. Optional (CA2_BENCH_PCL).
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <cstdio>

#include "core/lidar/board_candidate.h"
#include "tools/ca2/bench_lidar_scenes.h"
#include "tools/ca2/bench_timing.h"

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// As tutorials do it: clusters of returns closer than 8 cm to one another, a plane in each that is neither
/// too small for the board nor a wall. Returns how many planes.
int search_with_pcl(const Cloud::Ptr& cloud) {
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(cloud);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(0.08);
  extraction.setMinClusterSize(60);
  extraction.setMaxClusterSize(20000);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(cloud);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  int planes = 0;
  for (const pcl::PointIndices& cluster : clusters) {
    pcl::SACSegmentation<pcl::PointXYZ> ransac(false);
    ransac.setModelType(pcl::SACMODEL_PLANE);
    ransac.setMethodType(pcl::SAC_RANSAC);
    ransac.setDistanceThreshold(0.04);
    ransac.setMaxIterations(200);
    ransac.setInputCloud(cloud);
    ransac.setIndices(std::make_shared<pcl::PointIndices>(cluster));
    pcl::PointIndices inliers;
    pcl::ModelCoefficients coefficients;
    ransac.segment(inliers, coefficients);
    planes += inliers.indices.size() >= 60;
  }
  return planes;
}

}  // namespace

int main() {
  constexpr int scenes = 3, pairs = 9;
  const auto list = ca2::lidar_bench_scenes(scenes);
  if (!list) return std::fprintf(stderr, "%s\n", list.error().text().c_str()), 70;
  ca2::BoardFinder finder(ca2::lidar_bench_board());
  std::vector<double> ours, theirs, ratios;
  for (const ca2::LidarBenchScene& scene : *list) {
    const Cloud::Ptr cloud(new Cloud);
    for (const Eigen::Vector3f& p : scene.present.points) cloud->emplace_back(p.x(), p.y(), p.z());
    finder.find(scene.present);
    for (int i = 0; i < pairs; ++i) {
      const double start = ca2::cpu_ms();
      const auto found = finder.find(scene.present);
      const double between = ca2::cpu_ms();
      const int planes = search_with_pcl(cloud);
      const double end = ca2::cpu_ms();
      ca2::keep(&planes);
      ca2::keep(found.data());
      ours.push_back(between - start);
      theirs.push_back(end - between);
      ratios.push_back(ours.back() / theirs.back());
    }
  }
  std::printf("%d scans, %d pairs each: ours %.2f ms, PCL %.1f ms, ratio %.4f (median; worst %.4f)\n", scenes,
              pairs, ca2::median(ours), ca2::median(theirs), ca2::median(ratios),
              *std::max_element(ratios.begin(), ratios.end()));
  return 0;
}
