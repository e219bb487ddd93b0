#include "core/board/refine/saddle_fit.h"

#include <Eigen/LU>
#include <limits>

#include "core/board/refine/saddle_evaluator.h"
#include "core/geometry/levenberg_marquardt.h"

namespace ca2 {
namespace {

using namespace saddle_parameters;
using CrossRow = Eigen::Matrix<float, size, 1>;
using EdgeRow = Eigen::Matrix<float, common + per_edge, 1>;

/// Sums of one kind of pixel.
template <class Row>
struct Sums {
  static constexpr int rows = Row::RowsAtCompileTime;
  Eigen::Matrix<float, rows, rows> h = Eigen::Matrix<float, rows, rows>::Zero();
  Eigen::Matrix<double, rows, 1> g = Eigen::Matrix<double, rows, 1>::Zero();

  void add(const Row& row, double residual) {
    h.noalias() += row * row.transpose();
    g += residual * row.template cast<double>();
  }
};

class SaddleProblem : public DenseNormalEquations {
 public:
  using State = SaddleModel;

  SaddleProblem(const CornerPatch& patch, const SaddlePrior& prior, double tolerance)
      : patch_(patch), prior_(prior), tolerance_(tolerance) {}

  /// None of a step that hardly moves the corner nor turns its edges: how blurred the picture is, where that
  /// is next to nothing, need not be known better.
  double predicted_decrease(const Eigen::VectorXd& step) const {
    const bool tiny = step.head<2>().norm() < tolerance_ && std::abs(step[angle_]) < 10 * tolerance_ &&
                      std::abs(step[angle_ + per_edge]) < 10 * tolerance_;
    return tiny ? 0 : DenseNormalEquations::predicted_decrease(step);
  }

  /// An accepted step was judged by `cost` just before: its normal equations are there already.
  double linearize(const SaddleModel& model) {
    if (!judged_ || !(*judged_ == model)) cost(model);
    H = h_;
    g = gradient_;
    return total_;
  }

  double cost(const SaddleModel& model) {
    judged_ = model;
    total_ = std::numeric_limits<double>::infinity();
    if (std::abs(model.log_sigma[0]) > 4 || std::abs(model.log_sigma[1]) > 4) return total_;
    const SaddleEvaluator evaluator(model);
    Sums<CrossRow> cross;
    Sums<EdgeRow> edge[2];
    squares_ = 0;
    for (const PatchPixel& pixel : patch_.edge) {
      const SeenSaddle seen = evaluator.see(pixel.x, pixel.y);
      const double r = evaluator.grey(seen, pixel.x, pixel.y) - pixel.grey;
      squares_ += r * r;
      if (seen.edge[0] == seen.edge[1]) {
        CrossRow row;
        evaluator.common_row(seen, pixel.x, pixel.y, row);
        for (int i = 0; i < 2; ++i) evaluator.edge_row(seen, i, angle_ + i * per_edge, row);
        cross.add(row, r);
      } else {
        const int i = seen.edge[0] ? 0 : 1;
        EdgeRow row;
        evaluator.common_row(seen, pixel.x, pixel.y, row);
        evaluator.edge_row(seen, i, angle_, row);
        edge[i].add(row, r);
      }
    }
    h_ = cross.h.cast<double>();
    gradient_ = cross.g;
    const FlatPixels& flat = patch_.flat;
    const Eigen::Vector4d light(model.offset, model.gain, model.slope.x(), model.slope.y());
    const Eigen::Vector4d by_flat = flat.squares * light - flat.greys;
    h_.block<4, 4>(offset_, offset_) += flat.squares;
    gradient_.segment<4>(offset_) += by_flat;
    squares_ += light.dot(by_flat - flat.greys) + flat.grey_squares;
    for (int i = 0; i < 2; ++i) {
      const int at = angle_ + i * per_edge;
      const Eigen::Matrix<double, common + per_edge, common + per_edge> h = edge[i].h.cast<double>();
      h_.topLeftCorner<common, common>() += h.topLeftCorner<common, common>();
      h_.block<per_edge, per_edge>(at, at) += h.bottomRightCorner<per_edge, per_edge>();
      h_.block<per_edge, common>(at, 0) += h.bottomLeftCorner<per_edge, common>();
      h_.block<common, per_edge>(0, at) += h.topRightCorner<common, per_edge>();
      gradient_.head<common>() += edge[i].g.head<common>();
      gradient_.segment<per_edge>(at) += edge[i].g.tail<per_edge>();
    }
    add_priors(model);
    return total_;
  }

  static SaddleModel moved(const SaddleModel& model, const Eigen::VectorXd& step) {
    SaddleModel next = model;
    next.position += step.head<2>();
    for (int i = 0; i < 2; ++i) {
      next.angle[i] += step[angle_ + i * per_edge];
      next.log_sigma[i] += step[log_sigma_ + i * per_edge];
    }
    next.offset += step[offset_];
    next.gain += step[gain_];
    next.slope += step.segment<2>(slope_);
    return next;
  }

  /// Of the residuals at the model judged last, grey^2.
  double squares() const { return squares_; }

 private:
  void add_priors(const SaddleModel& model) {
    total_ = 0.5 * squares_;
    const Eigen::Vector2d off = model.slope - prior_.slope;
    h_.diagonal().segment<2>(slope_).array() += prior_.slope_weight;
    gradient_.segment<2>(slope_) += prior_.slope_weight * off;
    total_ += 0.5 * prior_.slope_weight * off.squaredNorm();
    for (int i = 0; i < 2; ++i) {
      const int at = log_sigma_ + i * per_edge;
      const double apart = model.log_sigma[i] - std::log(prior_.sigma[i]);
      h_(at, at) += prior_.log_sigma_weight;
      gradient_[at] += prior_.log_sigma_weight * apart;
      total_ += 0.5 * prior_.log_sigma_weight * apart * apart;
    }
  }

  const CornerPatch& patch_;
  SaddlePrior prior_;
  double tolerance_;  ///< px
  std::optional<SaddleModel> judged_;
  Eigen::Matrix<double, size, size> h_;  ///< at judged_
  Eigen::Matrix<double, size, 1> gradient_;
  double total_ = 0;
  double squares_ = 0;
};

/// Offset and gain that suit the pixels best with the rest as it is.
bool set_light(const CornerPatch& patch, SaddleModel& model) {
  const SaddleEvaluator evaluator(model);
  const FlatPixels& flat = patch.flat;
  double s = flat.squares(0, 0), sp = flat.squares(0, 1), spp = flat.squares(1, 1);
  double sg = flat.greys[0], spg = flat.greys[1];
  for (const PatchPixel& pixel : patch.edge) {
    const double p = evaluator.see(pixel.x, pixel.y).product;
    s += 1;
    sp += p;
    spp += p * p;
    sg += pixel.grey;
    spg += p * pixel.grey;
  }
  const double determinant = s * spp - sp * sp;
  if (determinant <= 1e-9 * s * s) return false;
  model.gain = (s * spg - sp * sg) / determinant;
  model.offset = (sg - model.gain * sp) / s;
  return true;
}

}  // namespace

double model_grey(const SaddleModel& model, double x, double y) {
  const SaddleEvaluator evaluator(model);
  return evaluator.grey(evaluator.see(x, y), x, y);
}

std::optional<SaddleFit> fit_saddle(const CornerPatch& patch, const SaddleModel& start,
                                    const SaddlePrior& prior, double tolerance) {
  const int count = static_cast<int>(patch.edge.size()) + patch.flat.count;
  if (count < 2 * size) return std::nullopt;
  SaddleModel model = start;
  if (!set_light(patch, model)) return std::nullopt;
  model.slope = prior.slope;
  model.light_origin = patch.origin;
  SaddleProblem problem(patch, prior, tolerance);
  LmOptions options;
  options.max_iterations = 20;
  // A step that promises a millionth of the cost is a thirtieth of a sigma, and is still taken.
  options.gradient_tolerance = 1e-6;
  options.step_tolerance = 1e-5;
  const LmReport report = minimize(problem, model, options);
  if (!std::isfinite(report.cost) || (model.position - start.position).norm() > 1.5) return std::nullopt;
  problem.linearize(model);
  const Eigen::Matrix<double, size, size> H = problem.H;
  const Eigen::Matrix2d coupled = H.topLeftCorner<2, 2>();
  const Eigen::LDLT<Eigen::Matrix<double, size - 2, size - 2>> nuisance(
      H.bottomRightCorner<size - 2, size - 2>());
  if (nuisance.info() != Eigen::Success || !nuisance.isPositive()) return std::nullopt;
  const Eigen::Matrix<double, size - 2, 2> cross = H.bottomLeftCorner<size - 2, 2>();
  SaddleFit fit;
  fit.model = model;
  fit.information = coupled - cross.transpose() * nuisance.solve(cross);
  fit.slope_variance =
      0.5 * H.ldlt().solve(Eigen::Matrix<double, size, size>::Identity()).diagonal().segment<2>(slope_).sum();
  fit.rms = std::sqrt(problem.squares() / (count - size));
  return fit;
}

}  // namespace ca2
