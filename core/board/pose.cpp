/// Where a camera sees the board: closed-form planar pose, then the least squares that the pixels ask for.
#include <Eigen/LU>
#include <Eigen/SVD>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "core/board/board.h"
#include "core/geometry/levenberg_marquardt.h"

namespace ca2 {
namespace {

struct Observation {
  Eigen::Vector3d p_board;   ///< m
  Eigen::Vector3d bearing;   ///< unit, camera frame
  Eigen::Vector2d pixel;     ///< px
  Eigen::Matrix2d whitener;  ///< inverse Cholesky factor of the pixel's covariance, 1/px
};

class PoseProblem : public DenseNormalEquations {
 public:
  using State = Pose;

  PoseProblem(const Camera& camera, std::span<const Observation> observations)
      : camera_(camera), observations_(observations) {}

  double linearize(const Pose& pose) {
    clear(6);
    double total = 0;
    for (const Observation& o : observations_) {
      ProjectionJacobian by;
      const auto pixel = camera_.project(pose * o.p_board, &by);
      if (!pixel) return std::numeric_limits<double>::infinity();
      const Eigen::Vector2d r = o.whitener * (*pixel - o.pixel);
      // Right perturbation: d(T p) = R ([-p]x w + v).
      Eigen::Matrix<double, 3, 6> by_pose;
      by_pose << -pose.R * skew(o.p_board), pose.R;
      const Eigen::Matrix<double, 2, 6> J = o.whitener * by.point * by_pose;
      H.noalias() += J.transpose() * J;
      g.noalias() += J.transpose() * r;
      total += 0.5 * r.squaredNorm();
    }
    return total;
  }

  double cost(const Pose& pose) const {
    double total = 0;
    for (const Observation& o : observations_) {
      const auto pixel = camera_.project(pose * o.p_board);
      if (!pixel) return std::numeric_limits<double>::infinity();
      total += 0.5 * (o.whitener * (*pixel - o.pixel)).squaredNorm();
    }
    return total;
  }

  static Pose moved(const Pose& pose, const Eigen::VectorXd& step) {
    Pose next = pose.perturbed(step);
    next.R = nearest_rotation(next.R);
    return next;
  }

 private:
  const Camera& camera_;
  std::span<const Observation> observations_;
};

/// The widest spread of the board points across their main direction, relative to along it.
double flatness(std::span<const Observation> observations) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Observation& o : observations) mean += o.p_board / static_cast<double>(observations.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Observation& o : observations) {
    const Eigen::Vector2d d = (o.p_board - mean).head<2>();
    scatter += d * d.transpose();
  }
  const Eigen::Vector2d s = scatter.jacobiSvd().singularValues();
  return s[0] > 0 ? std::sqrt(s[1] / s[0]) : 0;
}

/// Both planar poses that agree with the bearings (Collins and Bartoli, Infinitesimal Plane-based Pose
/// Estimation, IJCV 2014), in the camera's frame.
std::vector<Pose> planar_poses(std::span<const Observation> observations) {
  // A picture plane that faces the board, so that bearings beyond 90 degrees off the camera's axis have a
  // place on it.
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();
  for (const Observation& o : observations) towards += o.bearing;
  const Eigen::Matrix3d R_camera_virtual =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), towards).toRotationMatrix();
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const Observation& o : observations) {
    const Eigen::Vector3d b = R_camera_virtual.transpose() * o.bearing;
    if (b.z() < 0.05) continue;  // a corner so far aside tells a seed nothing
    points.emplace_back(o.p_board.x(), o.p_board.y(), o.p_board.z());
    pixels.emplace_back(b.x() / b.z(), b.y() / b.z());
  }
  std::vector<Pose> poses;
  if (points.size() < 4) return poses;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::solvePnPGeneric(points, pixels, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                      cv::SOLVEPNP_IPPE);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto vector = [](const cv::Mat& m) {
      return Eigen::Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
    };
    const Pose T_virtual_board{so3_exp(vector(rotations[i])), vector(translations[i])};
    poses.push_back(Pose{R_camera_virtual, Eigen::Vector3d::Zero()} * T_virtual_board);
  }
  return poses;
}

/// The corners that can take part: known to the board, with a bearing and a usable covariance.
std::vector<Observation> observations_of(const std::vector<Eigen::Vector2d>& points, const Camera& camera,
                                         std::span<const Corner> corners) {
  std::vector<Observation> observations;
  for (const Corner& corner : corners) {
    if (corner.id < 0 || static_cast<std::size_t>(corner.id) >= points.size()) continue;
    const auto bearing = camera.unproject(corner.pixel);
    const Eigen::LLT<Eigen::Matrix2d> llt(corner.covariance);
    if (!bearing || llt.info() != Eigen::Success) continue;
    const Eigen::Vector2d& p = points[static_cast<std::size_t>(corner.id)];
    observations.push_back(
        {{p.x(), p.y(), 0}, *bearing, corner.pixel, llt.matrixL().solve(Eigen::Matrix2d::Identity())});
  }
  return observations;
}

}  // namespace

std::vector<Eigen::Vector2d> printed_corners(const Board& board, const Eigen::Vector2d& stretch) {
  std::vector<Eigen::Vector2d> places = board.type->corners(board);
  for (Eigen::Vector2d& place : places) place += place.cwiseProduct(stretch);
  return places;
}

Result<BoardPose> estimate_board_pose(const Board& board, const Camera& camera,
                                      std::span<const Corner> corners, const Eigen::Vector2d& stretch) {
  const std::vector<Observation> observations =
      observations_of(printed_corners(board, stretch), camera, corners);
  if (observations.size() < 4) {
    return fail(ErrorCode::data, "",
                "only " + std::to_string(observations.size()) + " of " + std::to_string(corners.size()) +
                    " corners can be used, a pose needs 4",
                "check that the board and the camera's intrinsics are those of this picture");
  }
  if (flatness(observations) < 1e-3) {
    return fail(ErrorCode::data, "", "the corners lie on a line", "show more rows of the board");
  }
  PoseProblem problem(camera, observations);
  std::optional<Pose> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (Pose pose : planar_poses(observations)) {
    const double cost = minimize(problem, pose).cost;
    if (cost < best_cost) {
      best_cost = cost;
      best = pose;
    }
  }
  if (!best) {
    return fail(ErrorCode::data, "", "no pose of the board agrees with its corners",
                "check that the board and the camera's intrinsics are those of this picture");
  }
  BoardPose result;
  result.T_camera_board = *best;
  problem.linearize(*best);
  // Corners worse than they claim make the pose worse; corners better than they claim may be luck.
  const double freedom = 2.0 * static_cast<double>(observations.size()) - 6;
  const double excess = std::max(1.0, 2 * best_cost / freedom);
  result.covariance = excess * Matrix6d(problem.H).inverse();
  double squares = 0;
  for (const Observation& o : observations) {
    squares += (*camera.project(*best * o.p_board) - o.pixel).squaredNorm();
  }
  result.reprojection_rms = std::sqrt(squares / static_cast<double>(observations.size()));
  return result;
}

}  // namespace ca2
