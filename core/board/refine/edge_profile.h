/// @file The grey profile across a blurred edge, quickly: at a point, and as a pixel's area sees it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace ca2 {

/// erf(z / sqrt 2) and its derivative: the profile of a step from -1 to 1 under a Gaussian blur of sigma 1.
/// Interpolated from a table (cubic, from values and slopes; error below 1e-8): a fit evaluates it a million
/// times, and the C library's differs in the last digits between machines.
class EdgeProfile {
 public:
  struct Value {
    double value;
    double slope;
  };

  static constexpr int limit = 5;  ///< beyond, the step is over

  static Value at(double z) {
    if (z <= -limit) return {-1, 0};
    if (z >= limit) return {1, 0};
    const double u = (z + limit) * per_unit;
    const auto k = static_cast<std::size_t>(u);
    const double t = u - static_cast<double>(k);
    const Value& a = table()[k];
    const Value& b = table()[k + 1];
    const double h = 1.0 / per_unit;
    const double rise = b.value - a.value;
    const double c2 = 3 * rise - h * (2 * a.slope + b.slope);
    const double c3 = -2 * rise + h * (a.slope + b.slope);
    return {a.value + t * (h * a.slope + t * (c2 + t * c3)),
            (h * a.slope + t * (2 * c2 + t * 3 * c3)) * per_unit};
  }

 private:
  static constexpr int per_unit = 32;
  using Table = std::array<Value, 2 * limit * per_unit + 2>;

  static const Table& table() {
    static const Table values = [] {
      Table t;
      for (std::size_t k = 0; k < t.size(); ++k) {
        const double z = static_cast<double>(k) / per_unit - limit;
        t[k] = {std::erf(z / std::sqrt(2.0)), std::sqrt(2.0 / M_PI) * std::exp(-0.5 * z * z)};
      }
      return t;
    }();
    return values;
  }
};

/// A step from -1 to 1 across a line, under a Gaussian blur and averaged over the pixel's square. The
/// square's sides project on the normal of the line as two boxes of widths a = |cos angle| and b = |sin
/// angle|.
class PixelEdge {
 public:
  struct Value {
    double value;
    double slope;  ///< by the distance from the line, 1/px
    double bend;  ///< its derivative, 1/px^2; times sigma^2 it is the derivative by log sigma (heat equation)
  };

  /// Below this blur [px] the square's own shape counts.
  static constexpr double sharp_sigma = 0.45;

  PixelEdge() = default;
  /// `sharp`: exactly, down to no blur at all; otherwise as a wider Gaussian with the square's variance and
  /// fourth cumulant, which is 0.1 % off at sharp_sigma and three times as fast.
  PixelEdge(double angle, double sigma, bool sharp) : sharp_(sharp), sigma_(sigma) {
    // Edges along the pixels are one box only; a second one of 0.02 px changes nothing and needs no case.
    a_ = std::max(std::abs(std::cos(angle)), 0.02);
    b_ = std::max(std::abs(std::sin(angle)), 0.02);
    wide_ = std::sqrt(sigma * sigma + 1.0 / 12);
    per_wide_ = 1 / wide_;
    per_sigma_ = 1 / sigma;
    fourth_ = -(std::pow(a_, 4) + std::pow(b_, 4)) / 120 / (24 * std::pow(wide_, 4));
    support_ = 4 * (sharp ? sigma : wide_) + (sharp ? 0.5 * (a_ + b_) : 0);
  }

  /// One over sigma of blur and pixel together, 1/px.
  double per_wide() const { return per_wide_; }
  /// Distance from the line beyond which the value is -1 or 1 to 0.01 %, px.
  double support() const { return support_; }

  Value at(double distance) const { return sharp_ ? exact(distance) : gaussian(distance); }

 private:
  Value gaussian(double distance) const {
    const double z = distance * per_wide_;
    const EdgeProfile::Value e = EdgeProfile::at(z);
    const double q = z * z;
    const double slope = e.slope * per_wide_;
    return {e.value + fourth_ * z * (3 - q) * e.slope, slope * (1 + fourth_ * (q * (q - 6) + 3)),
            -slope * per_wide_ * z * (1 + fourth_ * (q * (q - 10) + 15))};
  }

  /// Integrating over a box is a difference of antiderivatives: two boxes, the second antiderivative of the
  /// blurred step at four places.
  Value exact(double distance) const {
    Value sum{0, 0, 0};
    for (const double side : {-0.5, 0.5}) {
      for (const double other : {-0.5, 0.5}) {
        const double z = (distance + side * a_ + other * b_) * per_sigma_;
        const EdgeProfile::Value e = EdgeProfile::at(z);
        const double sign = side * other > 0 ? 1 : -1;
        sum.bend += sign * e.value;
        sum.slope += sign * (z * e.value + e.slope);
        sum.value += sign * 0.5 * ((z * z + 1) * e.value + z * e.slope);
      }
    }
    const double per_area = 1 / (a_ * b_);
    return {sum.value * per_area * sigma_ * sigma_, sum.slope * per_area * sigma_, sum.bend * per_area};
  }

  bool sharp_ = false;
  double sigma_ = 1;
  double a_ = 1;
  double b_ = 0;
  double wide_ = 1;
  double per_wide_ = 1;
  double per_sigma_ = 1;
  double fourth_ = 0;
  double support_ = 0;
};

}  // namespace ca2
