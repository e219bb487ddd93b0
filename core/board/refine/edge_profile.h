/// @file The grey profile across a blurred edge, quickly.
#pragma once

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
  static constexpr int limit = 5;
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

}  // namespace ca2
