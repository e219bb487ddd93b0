#include "core/capture/gates.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/types/counted.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

// Pixels: smaller squares leave no room for the fit of a corner.
constexpr double least_square = 4.5;
// Pixels, standard deviation of a corner in one picture. Sharp ones reach a few hundredths.
constexpr double most_corner_sigma = 0.35;
// Beyond, a print fills too few pixels, and returns scatter along the surface.
constexpr double most_oblique = 72 * std::numbers::pi / 180;
// Of one scan: fewer leave the plane to chance.
constexpr std::size_t fewest_returns = 15;

double middle(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Middle distance of corners that are neighbours on the print, px.
double square_size(const Board& board, const std::vector<Corner>& corners) {
  const std::vector<Eigen::Vector2d> places = board.type->corners(board);
  std::vector<double> sides;
  for (const Corner& a : corners) {
    for (const Corner& b : corners) {
      if (b.id <= a.id) continue;
      const double apart =
          (places[static_cast<std::size_t>(a.id)] - places[static_cast<std::size_t>(b.id)]).norm();
      if (apart < 1.1 * board.square) sides.push_back((a.pixel - b.pixel).norm());
    }
  }
  return sides.empty() ? 0 : middle(std::move(sides));
}

int degrees(double angle) {
  return static_cast<int>(std::lround(angle * 180 / std::numbers::pi));
}

}  // namespace

std::string judge_camera(const std::string& name, const Board& board, const std::vector<Corner>& corners,
                         const std::optional<BoardPose>& pose) {
  const std::size_t all = board.type->corners(board).size();
  if (corners.size() < 8 || 3 * corners.size() < all) {
    return formatted("only %zu of the board's %zu corners %s visible in %s: is it cut off or covered?",
                     corners.size(), all, corners.size() == 1 ? "is" : "are", name.c_str());
  }
  if (const double side = square_size(board, corners); side < least_square) {
    return formatted("the board is too far from %s: its squares are %.1f px; come closer", name.c_str(),
                     side);
  }
  std::vector<double> sigmas;
  for (const Corner& corner : corners) sigmas.push_back(std::sqrt(corner.covariance.trace() / 2));
  if (const double sigma = middle(sigmas); sigma > most_corner_sigma) {
    return formatted(
        "the picture of %s is blurred: corners to %.2f px; more light, a shorter exposure or a "
        "sharper focus",
        name.c_str(), sigma);
  }
  if (pose) {
    const Pose& T = pose->T_camera_board;
    const double angle = std::acos(std::clamp(T.R.col(2).dot(T.t.normalized()), -1.0, 1.0));
    if (angle > most_oblique) {
      return formatted("%s sees the board too obliquely: %d degrees; turn it towards the camera",
                       name.c_str(), degrees(angle));
    }
  }
  return {};
}

std::string judge_lidar(const std::string& name, const LidarSight& sight) {
  if (sight.on_board.size() < fewest_returns) {
    return name + " has only " + counted(sight.on_board.size(), "return") + " on the board: come closer";
  }
  std::set<std::uint16_t> rings;
  for (const BoardReturn& here : sight.on_board) rings.insert(here.ring);
  if (rings.size() < 2 && !rings.contains(BoardReturn::no_ring)) {
    return formatted("only one ring of %s meets the board: come closer or turn its long side upright",
                     name.c_str());
  }
  const double angle = std::acos(std::clamp(-sight.plane.normal.dot(sight.center.normalized()), -1.0, 1.0));
  if (angle > most_oblique) {
    return formatted("%s sees the board too obliquely: %d degrees; turn it towards the lidar", name.c_str(),
                     degrees(angle));
  }
  return {};
}

std::string judge_stored(const Rig& rig, const ViewSights& view) {
  bool seen = false;
  std::size_t index = 0;
  for (const auto& [name, camera] : rig.cameras) {
    const std::size_t c = index++;
    if (c >= view.cameras.size() || !view.cameras[c]) continue;
    seen = true;
    const std::optional<BoardPose> pose =
        camera.intrinsics ? std::optional(view.cameras[c]->pose) : std::nullopt;
    if (std::string why = judge_camera(name, rig.board, view.cameras[c]->corners, pose); !why.empty()) {
      return why;
    }
  }
  return seen ? "" : "the picture is too blurred to see the board in it: more light or a steadier hand";
}

}  // namespace ca2
