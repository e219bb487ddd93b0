#include "core/intrinsics/validate_intrinsics.h"

#include <cmath>
#include <limits>

namespace ca2 {

std::optional<double> held_out_error(const Board& board, int width, int height, std::string_view model,
                                     std::span<const std::vector<Corner>> views, int folds) {
  const std::vector<Eigen::Vector2d> places = board.type->corners(board);
  double squares = 0;
  std::size_t count = 0;
  for (int fold = 0; fold < folds; ++fold) {
    std::vector<std::vector<Corner>> rest, kept;
    for (std::size_t i = 0; i < views.size(); ++i) {
      (static_cast<int>(i) % folds == fold ? kept : rest).push_back(views[i]);
    }
    if (kept.empty()) continue;
    const auto estimate = estimate_intrinsics(board, width, height, model, rest);
    if (!estimate) return std::nullopt;
    for (const std::vector<Corner>& corners : kept) {
      const Result<BoardPose> pose = estimate_board_pose(board, estimate->camera, corners);
      if (!pose) continue;  // a picture without the board tells nothing
      for (const Corner& corner : corners) {
        const Eigen::Vector2d& at = places[static_cast<std::size_t>(corner.id)];
        const auto pixel =
            estimate->camera.project(pose->T_camera_board * Eigen::Vector3d(at.x(), at.y(), 0));
        if (!pixel) continue;
        squares += (*pixel - corner.pixel).squaredNorm();
        ++count;
      }
    }
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(squares / static_cast<double>(2 * count));
}

std::vector<IntrinsicsTrial> try_models(const Board& board, int width, int height,
                                        const std::vector<std::string>& models,
                                        std::span<const std::vector<Corner>> views) {
  std::vector<IntrinsicsTrial> trials;
  for (const std::string& model : models) {
    auto estimate = estimate_intrinsics(board, width, height, model, views);
    std::optional<double> error;
    if (estimate) error = held_out_error(board, width, height, model, views);
    trials.push_back({model, std::move(estimate), error});
  }
  return trials;
}

const IntrinsicsTrial* best_trial(const std::vector<IntrinsicsTrial>& trials) {
  // Where the rest of the views never suffices there is nothing to compare but the fit itself.
  const auto error = [](const IntrinsicsTrial& trial) {
    return trial.held_out.value_or(1e3 * trial.estimate->reprojection_rms);
  };
  double least = std::numeric_limits<double>::infinity();
  for (const IntrinsicsTrial& trial : trials) {
    if (trial.estimate) least = std::min(least, error(trial));
  }
  const IntrinsicsTrial* best = nullptr;
  for (const IntrinsicsTrial& trial : trials) {
    if (!trial.estimate || error(trial) > 1.02 * least) continue;
    if (!best || trial.estimate->camera.parameters.size() < best->estimate->camera.parameters.size())
      best = &trial;
  }
  return best;
}

}  // namespace ca2
