// The paper's way to a board's plane: a person picks the board in the
// projection by ID.
// Compiled here from PCL's templates: its library of them takes 5 MB of every process, and the loader's time.
#define PCL_NO_PRECOMPILE
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_plane.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/lidar/board_candidate.h"
#include "core/lidar/covered_returns.h"
#include "core/lidar/outline_fit.h"
#include "core/lidar/ray_plane.h"
#include "core/types/counted.h"

namespace ca2 {
namespace {

constexpr double kInlier = 0.05;  // m from the plane: 2.5 times the noise of the worst sensor
constexpr int kFewest = 10;       // returns; with fewer a plane says nothing

/// Half widths of the patch in rings and columns.
struct PatchSize {
  double rows, columns;
};

/// Where no radius is given: what covers 0.35 of the board's shorter side at
/// the picked range.
PatchSize default_size(const RingImage& image, int row, float range, double short_side) {
  const double angle = 0.35 * short_side / range;
  return {std::max(1.0, angle / image.row_angle[static_cast<std::size_t>(row)]),
          std::max(2.0, angle / image.column_angle)};
}

/// The range of the picked cell, or of the nearest returns beside it when it is
/// empty; 0 when there are none.
float picked_range(const RingImage& image, int row, int column) {
  for (int away = 0; away <= 3; ++away) {
    for (const int c : {column - away, column + away}) {
      const float range = image.range[image.index(row, image.wrap(c))];
      if (range > 0) return range;
    }
  }
  return 0;
}

std::vector<std::uint32_t> patch_returns(const Projection& projection, const RingImage& image, int row,
                                         int column, const PatchSize& size) {
  std::vector<std::uint32_t> list;
  const int half = std::min(static_cast<int>(size.columns), image.columns / 2 - 1);
  for (int r = std::max(0, row - static_cast<int>(size.rows)); r < image.rows && r - row <= size.rows; ++r) {
    for (int k = -half; k <= half; ++k) {
      const double a = (r - row) / size.rows, b = k / size.columns;
      if (a * a + b * b > 1) continue;
      const auto cell = projection.cell(image.ring[static_cast<std::size_t>(r)], image.wrap(column + k));
      list.insert(list.end(), cell.begin(), cell.end());
    }
  }
  return list;
}

std::string place_text(int row, int column) {
  return "row " + std::to_string(row) + ", column " + std::to_string(column);
}

}  // namespace

Result<BoardCandidate> fit_picked_patch(const Scan& scan, const Board& board, int row, int column,
                                        double radius) {
  const Projection projection = project_by_id(scan);
  const RingImage image = make_ring_image(projection, scan);
  if (row < 0 || row >= projection.rings || column < 0 || column >= projection.columns) {
    return fail(ErrorCode::data, place_text(row, column), "the picked pixel is outside the projection",
                "rows are 0.." + std::to_string(projection.rings - 1) + ", columns 0.." +
                    std::to_string(projection.columns - 1));
  }
  if (!(radius >= 0) || radius > 1e4) {
    return fail(ErrorCode::data, place_text(row, column), "the radius is not a number of cells",
                "give 0 for the default");
  }
  const auto at = std::find(image.ring.begin(), image.ring.end(), row);
  const int image_row = static_cast<int>(at - image.ring.begin());
  const float range = at == image.ring.end() ? 0 : picked_range(image, image_row, column);
  if (range == 0) {
    return fail(ErrorCode::data, place_text(row, column), "nothing came back there",
                "pick a pixel on the board, away from its rim");
  }
  const Outline extent = board.extent();
  const double short_side = std::min(extent.width, extent.height);
  const PatchSize size = radius > 0 ? PatchSize{std::max(radius, 1.0), std::max(radius, 1.0)}
                                    : default_size(image, image_row, range, short_side);
  const std::vector<std::uint32_t> patch = patch_returns(projection, image, image_row, column, size);
  const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const std::uint32_t i : patch)
    cloud->emplace_back(scan.points[i].x(), scan.points[i].y(), scan.points[i].z());
  pcl::Indices inliers;
  if (patch.size() >= static_cast<std::size_t>(kFewest)) {
    // PCL's SACSegmentation does just this, but its library takes the loader 60 ms of every start of a
    // program.
    const auto model = std::make_shared<pcl::SampleConsensusModelPlane<pcl::PointXYZ>>(
        cloud, false);  // false: PCL's fixed seed
    pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, kInlier);
    ransac.setMaxIterations(500);
    if (ransac.computeModel()) {
      Eigen::VectorXf plane, refined;
      ransac.getInliers(inliers);
      ransac.getModelCoefficients(plane);
      model->optimizeModelCoefficients(inliers, plane, refined);
      model->selectWithinDistance(refined, kInlier, inliers);
    }
  }
  if (inliers.size() < static_cast<std::size_t>(kFewest)) {
    return fail(ErrorCode::data, place_text(row, column),
                "no plane in the " + counted(patch.size(), "return") + " of the patch",
                "pick the middle of the board, or give another radius");
  }
  BoardCandidate candidate;
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int k : inliers) {
    candidate.returns.push_back(patch[static_cast<std::size_t>(k)]);
    points.push_back(scan.points[candidate.returns.back()].cast<double>());
    centre += points.back() / static_cast<double>(inliers.size());
  }
  double normal_rms = 0;
  const RangeFit fit = fit_ranges(points, fit_plane(points, &normal_rms));
  candidate.plane = fit.plane;
  candidate.rms = fit.rms;
  const PatchContext context{scan, projection, image, extent.width, extent.height, normal_rms};
  const double band = std::clamp(3.5 * normal_rms, 0.02, 0.08);
  candidate.T_lidar_board = pose_of(
      place_rectangle(context, fit.plane, centre, {0.95 * std::hypot(extent.width, extent.height), band}),
      fit.plane);
  const Eigen::Vector3d& board_centre = candidate.T_lidar_board.t;
  const std::vector<PatchRay> rays = view_patch(image, {fit.plane, board_centre},
                                                covered_reach(extent.width, extent.height), band, SIZE_MAX);
  candidate.covered = find_covered_returns(projection, image, fit.plane, board_centre, rays, fit.sigma);
  if (board.outline) {
    candidate.crossings = find_edge_crossings(
        scan, projection,
        {candidate.plane, candidate.T_lidar_board, extent.width, extent.height, fit.rms, candidate.covered});
  }
  if (projection.beams) {
    candidate.beam_height = projection.height;
    candidate.found_ring = projection.found_ring;
  }
  candidate.score = static_cast<double>(inliers.size()) / static_cast<double>(patch.size());
  candidate.why = "picked by hand: " + std::to_string(inliers.size()) + " of " +
                  counted(patch.size(), "return") + " on the plane";
  return candidate;
}

}  // namespace ca2
