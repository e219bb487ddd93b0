#include "core/solve/corner_doubts.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/solve/view_elimination.h"

namespace ca2 {
namespace {

constexpr double certain_enough = 6.9;  ///< logarithm of a thousand
constexpr double reach = 1e-3;          ///< nothing moves while it is looked at

/// What one camera's corners say of its parameters and the stretch, the boards' poses eliminated, in units of
/// the corners' stated noise.
struct CameraEvidence {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  CameraParameters moves;  ///< px: how far a unit of each parameter moves a corner at most
  std::vector<CornerField> fields;
  std::vector<Pose> poses;  ///< T_camera_board, by field
};

CameraEvidence evidence_of(const JointInput& input, const JointState& state, std::size_t c) {
  const Camera& camera = state.cameras[c];
  const auto parameters = camera.parameters.size();
  const CornerUnknowns unknowns{static_cast<int>(parameters), true};
  CameraEvidence evidence;
  evidence.H.setZero(parameters + 2, parameters + 2);
  evidence.g.setZero(parameters + 2);
  evidence.moves.setZero(parameters);
  evidence.fields.reserve(input.views.size());
  const double scale = input.corner_scale[c];
  Elimination pose;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    if (input.views[v].corners[c].empty()) continue;
    CornerField field(input.views[v].corners[c], input.board_corners, unknowns);
    const Pose T_camera_board = state.T_ref_camera[c].inverse() * state.T_ref_board[v];
    const CornerModel model{camera, T_camera_board, state.stretch};
    if (!field.approach(model, scale, input.corner_huber, reach)) continue;
    const CameraEquations equations = field.equations(model, scale, input.corner_huber);
    evidence.H += equations.H.bottomRightCorner(parameters + 2, parameters + 2);
    evidence.g += equations.g.tail(parameters + 2);
    pose.eliminate({equations.H.topLeftCorner<6, 6>(), equations.H.topRightCorner(6, parameters + 2),
                    equations.g.head<6>()},
                   0);
    pose.subtract_from(evidence.H, evidence.g);
    evidence.moves = evidence.moves.cwiseMax(field.moves());
    evidence.fields.push_back(std::move(field));
    evidence.poses.push_back(T_camera_board);
  }
  evidence.H.triangularView<Eigen::StrictlyUpper>() = evidence.H.transpose();
  evidence.H *= scale * scale;
  evidence.g *= scale * scale;
  return evidence;
}

/// All cameras' together: the parameters of each, then the stretch.
struct Whole {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};

class Doubts {
 public:
  Doubts(const JointInput& input, const JointState& state, const NeighbourTable& neighbours,
         const DoubtPriors& priors)
      : input_(input), state_(state), neighbours_(neighbours), scale_(input.corner_scale) {
    for (std::size_t c = 0; c < input.cameras.size(); ++c) {
      cameras_.push_back(evidence_of(input, state, c));
      const auto count = cameras_.back().moves.size();
      first_.push_back(size_);
      size_ += count;
    }
    sigma_.setZero(size_ + 2);
    deviation_.setZero(size_ + 2);
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const CameraParameters& pinhole = input.prior_intrinsics[c];
      if (!(pinhole.head<4>().minCoeff() > 0)) continue;
      sigma_.segment<4>(first_[c]) = pinhole.head<4>();
      deviation_.segment<4>(first_[c]) =
          (state.cameras[c].parameters - input.cameras[c].parameters).head<4>();
      const auto more = cameras_[c].moves.size() - 4;
      // What moves no corner cannot be told, and need not.
      sigma_.segment(first_[c] + 4, more) =
          priors.distortion * cameras_[c].moves.tail(more).cwiseMax(1e-6).cwiseInverse();
    }
    sigma_.tail<2>().setConstant(priors.stretch);
  }

  CornerDoubts find() {
    estimate_noise();
    const Whole whole = sum();
    // Every camera's distortion is a candidate, and the print.
    const std::size_t print = cameras_.size();
    std::vector<bool> open(cameras_.size() + 1, false);
    double known = log_evidence(whole, open);
    for (;;) {
      double best = known + certain_enough;
      std::size_t opened = open.size();
      for (std::size_t k = 0; k < open.size(); ++k) {
        if (open[k]) continue;
        open[k] = true;
        const double value = log_evidence(whole, open);
        open[k] = false;
        if (!(value > best)) continue;
        best = value;
        opened = k;
      }
      if (opened == open.size()) break;
      open[opened] = true;
      known = best;
    }
    CornerDoubts doubts{std::vector<CameraParameters>(cameras_.size()), open[print] ? sigma_(size_) : 0};
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      if (open[c]) doubts.distortion[c] = sigma_.segment(first_[c] + 4, cameras_[c].moves.size() - 4);
    }
    return doubts;
  }

 private:
  Whole sum() const {
    Whole whole{Eigen::MatrixXd::Zero(size_ + 2, size_ + 2), Eigen::VectorXd::Zero(size_ + 2)};
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const double information = 1 / (scale_[c] * scale_[c]);
      const auto n = cameras_[c].moves.size();
      const Eigen::MatrixXd H = information * cameras_[c].H;
      const Eigen::VectorXd g = information * cameras_[c].g;
      whole.H.block(first_[c], first_[c], n, n) += H.topLeftCorner(n, n);
      whole.H.block(first_[c], size_, n, 2) += H.topRightCorner(n, 2);
      whole.H.block(size_, first_[c], 2, n) += H.bottomLeftCorner(2, n);
      whole.H.bottomRightCorner<2, 2>() += H.bottomRightCorner<2, 2>();
      whole.g.segment(first_[c], n) += g.head(n);
      whole.g.tail<2>() += g.tail<2>();
    }
    return whole;
  }

  /// What the noise is like where all the doubts are right. Under what is believed it would be large enough
  /// to explain what is wrong with it.
  void estimate_noise() {
    const Whole whole = sum();
    const Eigen::MatrixXd unit = Eigen::MatrixXd(sigma_.asDiagonal() * whole.H * sigma_.asDiagonal()) +
                                 Eigen::MatrixXd::Identity(size_ + 2, size_ + 2);
    const Eigen::VectorXd pull = sigma_.cwiseProduct(whole.g) + deviation_.cwiseProduct(inverse_sigma());
    const Eigen::VectorXd change = -sigma_.cwiseProduct(unit.llt().solve(pull));
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      Camera camera = state_.cameras[c];
      camera.parameters += change.segment(first_[c], camera.parameters.size());
      CornerNoise noise;
      for (std::size_t i = 0; i < cameras_[c].fields.size(); ++i) {
        const CornerModel model{camera, cameras_[c].poses[i], state_.stretch + change.tail<2>()};
        const CornerField& field = cameras_[c].fields[i];
        noise.add_view(field, field.errors_about_own_pose(model), neighbours_);
      }
      if (const auto scale = noise.scale()) scale_[c] = *scale;
    }
  }

  Eigen::VectorXd inverse_sigma() const {
    return sigma_.unaryExpr([](double sigma) { return sigma > 0 ? 1 / sigma : 0; });
  }

  /// Of the views, relative to nothing being free, in which the pinhole parameters always are.
  double log_evidence(const Whole& whole, const std::vector<bool>& open) const {
    std::vector<Eigen::Index> free;
    const auto add = [&](Eigen::Index i) {
      if (sigma_(i) > 0) free.push_back(i);
    };
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const Eigen::Index count = open[c] ? cameras_[c].moves.size() : 4;
      for (Eigen::Index k = 0; k < count; ++k) add(first_[c] + k);
    }
    for (Eigen::Index k = 0; open.back() && k < 2; ++k) add(size_ + k);
    if (free.empty()) return 0;
    const Eigen::VectorXd sigma = sigma_(free);
    const Eigen::VectorXd g = sigma.cwiseProduct(whole.g(free)) + deviation_(free).cwiseQuotient(sigma);
    const auto count = static_cast<Eigen::Index>(free.size());
    const Eigen::LLT<Eigen::MatrixXd> llt(
        Eigen::MatrixXd(sigma.asDiagonal() * whole.H(free, free) * sigma.asDiagonal()) +
        Eigen::MatrixXd::Identity(count, count));
    return 0.5 * g.dot(llt.solve(g)) - llt.matrixLLT().diagonal().array().log().sum();
  }

  const JointInput& input_;
  const JointState& state_;
  const NeighbourTable& neighbours_;
  std::vector<double> scale_;  ///< by camera: of the corners' stated noise
  std::vector<CameraEvidence> cameras_;
  std::vector<Eigen::Index> first_;  ///< by camera: of its parameters
  Eigen::Index size_ = 0;            ///< all cameras' parameters
  Eigen::VectorXd sigma_;            ///< of the parameters and the stretch; 0: held
  Eigen::VectorXd deviation_;        ///< of the parameters at the state from the given ones
};

}  // namespace

bool CornerDoubts::any() const {
  return stretch > 0 || std::any_of(distortion.begin(), distortion.end(),
                                    [](const CameraParameters& sigma) { return sigma.size() > 0; });
}

void CornerDoubts::open(JointInput& input) const {
  for (std::size_t c = 0; c < distortion.size(); ++c) {
    CameraParameters& sigma = input.prior_intrinsics[c];
    sigma.conservativeResize(4 + distortion[c].size());
    sigma.tail(distortion[c].size()) = distortion[c];
  }
  if (stretch > 0) input.prior_stretch = stretch;
}

CornerDoubts doubt_corners(const JointInput& input, const JointState& state, const NeighbourTable& neighbours,
                           const DoubtPriors& priors) {
  return Doubts(input, state, neighbours, priors).find();
}

}  // namespace ca2
