#include "core/board/refine/saddle_fit.h"

#include <Eigen/LU>
#include <limits>

#include "core/board/refine/edge_profile.h"
#include "core/geometry/levenberg_marquardt.h"

namespace ca2 {
namespace {

constexpr int size = 10;
using Row = Eigen::Matrix<double, size, 1>;
// Order of the parameters.
enum { x_, y_, angle_, log_sigma_ = 4, offset_ = 6, gain_, slope_ };

/// The model with what does not change from pixel to pixel worked out.
class Evaluator {
 public:
  explicit Evaluator(const SaddleModel& model) : m_(model) {
    for (int i = 0; i < 2; ++i) {
      t_[i] = {std::cos(m_.angle[i]), std::sin(m_.angle[i])};
      n_[i] = {-t_[i].y(), t_[i].x()};
      inverse_sigma_[i] = std::exp(-m_.log_sigma[i]);
    }
    rho_ = n_[0].dot(n_[1]);
    rho_slope_ = std::sin(m_.angle[1] - m_.angle[0]);
  }

  double grey(double x, double y, Row* by) const {
    double product = 0;
    Eigen::Matrix<double, 6, 1> by_shape = Eigen::Matrix<double, 6, 1>::Zero();  // x y angles log_sigmas
    if (m_.points_per_pixel == 1) {
      // Under a wide blur the pixel's area only adds to the blur.
      add_point(x, y, 1, product, by != nullptr ? &by_shape : nullptr);
    } else {
      // Two Gauss points each way integrate over the pixel's area (exact for cubics): without it a sharp
      // picture pulls the corner towards pixel centres.
      constexpr double half = 0.28867513459481287;
      for (const double sy : {-half, half}) {
        for (const double sx : {-half, half}) {
          add_point(x + sx, y + sy, 0.25, product, by != nullptr ? &by_shape : nullptr);
        }
      }
    }
    const Eigen::Vector2d d(x - m_.position.x(), y - m_.position.y());
    if (by != nullptr) {
      by->head<6>() = m_.gain * by_shape;
      by->head<2>() -= m_.slope;
      (*by)[offset_] = 1;
      (*by)[gain_] = product;
      by->segment<2>(slope_) = d;
    }
    return m_.offset + m_.slope.dot(d) + m_.gain * product;
  }

 private:
  /// Adds M(z0, z1) at a place, and its derivatives, with a weight.
  void add_point(double x, double y, double weight, double& product,
                 Eigen::Matrix<double, 6, 1>* by_shape) const {
    const double dx = x - m_.position.x();
    const double dy = y - m_.position.y();
    double along[2], across[2], z[2];
    EdgeProfile::Value e[2];
    for (int i = 0; i < 2; ++i) {
      along[i] = t_[i].x() * dx + t_[i].y() * dy;
      across[i] = n_[i].x() * dx + n_[i].y() * dy;
      z[i] = (across[i] + m_.curvature[i] * along[i] * along[i]) * inverse_sigma_[i];
      e[i] = EdgeProfile::at(z[i]);
    }
    const double both = weight * e[0].slope * e[1].slope;
    const double q0 = z[0] * z[0] - 1;
    const double q1 = z[1] * z[1] - 1;
    const double r2 = rho_ * rho_;
    const double terms = rho_ + r2 * z[0] * z[1] / 2 + r2 * rho_ * q0 * q1 / 6;
    product += weight * e[0].value * e[1].value + both * terms;
    if (by_shape == nullptr || (e[0].slope == 0 && e[1].slope == 0)) return;
    const double by_z[2] = {
        weight * e[0].slope * e[1].value + both * (r2 * z[1] / 2 + r2 * rho_ * z[0] * q1 / 3 - z[0] * terms),
        weight * e[1].slope * e[0].value + both * (r2 * z[0] / 2 + r2 * rho_ * z[1] * q0 / 3 - z[1] * terms)};
    const double by_rho = both * (1 + rho_ * z[0] * z[1] + r2 * q0 * q1 / 2);
    for (int i = 0; i < 2; ++i) {
      const double bend = 2 * m_.curvature[i] * along[i];
      const double scaled = by_z[i] * inverse_sigma_[i];
      (*by_shape)[0] -= scaled * (n_[i].x() + bend * t_[i].x());
      (*by_shape)[1] -= scaled * (n_[i].y() + bend * t_[i].y());
      (*by_shape)[2 + i] +=
          scaled * (bend * across[i] - along[i]) + (i == 0 ? rho_slope_ : -rho_slope_) * by_rho;
      (*by_shape)[4 + i] -= by_z[i] * z[i];
    }
  }

  const SaddleModel& m_;
  Eigen::Vector2d t_[2];
  Eigen::Vector2d n_[2];
  double inverse_sigma_[2];
  double rho_;
  double rho_slope_;  ///< by the first angle; by the second its negative
};

class SaddleProblem : public DenseNormalEquations {
 public:
  using State = SaddleModel;

  SaddleProblem(std::span<const PatchPixel> pixels, const SlopePrior& prior)
      : pixels_(pixels), prior_(prior) {}

  /// An accepted step was judged by `cost` just before: its normal equations are there already.
  double linearize(const SaddleModel& model) {
    if (!judged_ || !(*judged_ == model)) cost(model);
    H = h_.selfadjointView<Eigen::Lower>();
    g = gradient_;
    return total_;
  }

  double cost(const SaddleModel& model) {
    judged_ = model;
    total_ = std::numeric_limits<double>::infinity();
    if (std::abs(model.log_sigma[0]) > 4 || std::abs(model.log_sigma[1]) > 4) return total_;
    const Evaluator evaluator(model);
    h_.setZero();
    gradient_.setZero();
    total_ = 0;
    Row row;
    for (const PatchPixel& pixel : pixels_) {
      const double r = evaluator.grey(pixel.x, pixel.y, &row) - pixel.grey;
      for (int i = 0; i < size; ++i) h_.col(i).tail(size - i) += row[i] * row.tail(size - i);
      gradient_ += r * row;
      total_ += 0.5 * r * r;
    }
    const Eigen::Vector2d off = model.slope - prior_.mean;
    h_.diagonal().segment<2>(slope_).array() += prior_.weight;
    gradient_.segment<2>(slope_) += prior_.weight * off;
    total_ += 0.5 * prior_.weight * off.squaredNorm();
    return total_;
  }

  static SaddleModel moved(const SaddleModel& model, const Eigen::VectorXd& step) {
    SaddleModel next = model;
    next.position += step.head<2>();
    for (int i = 0; i < 2; ++i) {
      next.angle[i] += step[angle_ + i];
      next.log_sigma[i] += step[log_sigma_ + i];
    }
    next.offset += step[offset_];
    next.gain += step[gain_];
    next.slope += step.segment<2>(slope_);
    return next;
  }

 private:
  std::span<const PatchPixel> pixels_;
  SlopePrior prior_;
  std::optional<SaddleModel> judged_;
  Eigen::Matrix<double, size, size> h_;  ///< lower half, at judged_
  Row gradient_;
  double total_ = 0;
};

/// Offset and gain that suit the pixels best with the rest as it is.
bool set_light(std::span<const PatchPixel> pixels, SaddleModel& model) {
  model.offset = 0;
  model.gain = 1;
  model.slope.setZero();
  const Evaluator evaluator(model);
  double s = 0, sp = 0, spp = 0, sg = 0, spg = 0;
  for (const PatchPixel& pixel : pixels) {
    const double p = evaluator.grey(pixel.x, pixel.y, nullptr);
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
  return Evaluator(model).grey(x, y, nullptr);
}

std::optional<SaddleFit> fit_saddle(std::span<const PatchPixel> pixels, const SaddleModel& start,
                                    const SlopePrior& prior) {
  if (pixels.size() < 2 * size) return std::nullopt;
  SaddleModel model = start;
  if (!set_light(pixels, model)) return std::nullopt;
  model.slope = prior.mean;
  SaddleProblem problem(pixels, prior);
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
  fit.rms = std::sqrt(2 * report.cost / static_cast<double>(pixels.size() - size));
  fit.pixels = static_cast<int>(pixels.size());
  return fit;
}

}  // namespace ca2
