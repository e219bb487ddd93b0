#include "core/board/refine/saddle_fit.h"

#include <Eigen/LU>
#include <limits>

#include "core/board/refine/edge_profile.h"
#include "core/solve/levenberg_marquardt.h"

namespace ca2 {
namespace {

constexpr int size = 10;
using Row = Eigen::Matrix<double, size, 1>;
// Order of the parameters.
enum { x_, y_, angle_, log_sigma_ = 4, offset_ = 6, gain_, shading_ };

/// The model with what does not change from pixel to pixel worked out.
class Evaluator {
 public:
  explicit Evaluator(const SaddleModel& model) : m_(model) {
    for (int i = 0; i < 2; ++i) {
      t_[i] = {std::cos(m_.angle[i]), std::sin(m_.angle[i])};
      n_[i] = {-t_[i].y(), t_[i].x()};
      inverse_sigma_[i] = std::exp(-m_.log_sigma[i]);
    }
  }

  double grey(double x, double y, Row* by) const {
    double product = 0;
    Eigen::Matrix<double, 6, 1> by_shape = Eigen::Matrix<double, 6, 1>::Zero();  // x y angles log_sigmas
    // Two Gauss points each way integrate over the pixel's area (exact for cubics): without it a sharp
    // picture pulls the corner towards pixel centres.
    constexpr double half = 0.28867513459481287;
    for (const double sy : {-half, half}) {
      for (const double sx : {-half, half}) {
        const Eigen::Vector2d d(x + sx - m_.position.x(), y + sy - m_.position.y());
        double along[2], across[2], z[2];
        EdgeProfile::Value e[2];
        for (int i = 0; i < 2; ++i) {
          along[i] = t_[i].dot(d);
          across[i] = n_[i].dot(d);
          z[i] = (across[i] + m_.curvature[i] * along[i] * along[i]) * inverse_sigma_[i];
          e[i] = EdgeProfile::at(z[i]);
        }
        product += 0.25 * e[0].value * e[1].value;
        if (by == nullptr) continue;
        for (int i = 0; i < 2; ++i) {
          const double slope = 0.25 * e[i].slope * e[1 - i].value;
          if (slope == 0) continue;
          const double bend = 2 * m_.curvature[i] * along[i];
          const double scaled = slope * inverse_sigma_[i];
          by_shape[0] -= scaled * (n_[i].x() + bend * t_[i].x());
          by_shape[1] -= scaled * (n_[i].y() + bend * t_[i].y());
          by_shape[2 + i] += scaled * (bend * across[i] - along[i]);
          by_shape[4 + i] -= slope * z[i];
        }
      }
    }
    const Eigen::Vector2d d(x - m_.position.x(), y - m_.position.y());
    const double light = 1 + m_.shading.dot(d);
    const double print = m_.offset + m_.gain * product;
    if (by != nullptr) {
      by->head<6>() = light * m_.gain * by_shape;
      by->head<2>() -= print * m_.shading;
      (*by)[offset_] = light;
      (*by)[gain_] = light * product;
      by->segment<2>(shading_) = print * d;
    }
    return light * print;
  }

 private:
  const SaddleModel& m_;
  Eigen::Vector2d t_[2];
  Eigen::Vector2d n_[2];
  double inverse_sigma_[2];
};

class SaddleProblem : public DenseNormalEquations {
 public:
  using State = SaddleModel;

  explicit SaddleProblem(std::span<const PatchPixel> pixels) : pixels_(pixels) {}

  double linearize(const SaddleModel& model) {
    const Evaluator evaluator(model);
    Eigen::Matrix<double, size, size> h = Eigen::Matrix<double, size, size>::Zero();
    Row gradient = Row::Zero();
    double total = 0;
    Row row;
    for (const PatchPixel& pixel : pixels_) {
      const double r = evaluator.grey(pixel.x, pixel.y, &row) - pixel.grey;
      h.selfadjointView<Eigen::Lower>().rankUpdate(row);
      gradient += r * row;
      total += 0.5 * r * r;
    }
    H = h.selfadjointView<Eigen::Lower>();
    g = gradient;
    return total;
  }

  double cost(const SaddleModel& model) const {
    if (std::abs(model.log_sigma[0]) > 4 || std::abs(model.log_sigma[1]) > 4) {
      return std::numeric_limits<double>::infinity();
    }
    const Evaluator evaluator(model);
    double total = 0;
    for (const PatchPixel& pixel : pixels_) {
      const double r = evaluator.grey(pixel.x, pixel.y, nullptr) - pixel.grey;
      total += 0.5 * r * r;
    }
    return total;
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
    next.shading += step.segment<2>(shading_);
    return next;
  }

 private:
  std::span<const PatchPixel> pixels_;
};

/// Offset and gain that suit the pixels best with the rest as it is.
bool set_light(std::span<const PatchPixel> pixels, SaddleModel& model) {
  model.offset = 0;
  model.gain = 1;
  model.shading.setZero();
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

std::optional<SaddleFit> fit_saddle(std::span<const PatchPixel> pixels, const SaddleModel& start) {
  if (pixels.size() < 2 * size) return std::nullopt;
  SaddleModel model = start;
  if (!set_light(pixels, model)) return std::nullopt;
  SaddleProblem problem(pixels);
  LmOptions options;
  options.max_iterations = 20;
  // A ten thousandth of a grey value and of a pixel are far below any noise.
  options.gradient_tolerance = 1e-8;
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
  fit.rms = std::sqrt(2 * report.cost / static_cast<double>(pixels.size() - size));
  fit.pixels = static_cast<int>(pixels.size());
  return fit;
}

}  // namespace ca2
