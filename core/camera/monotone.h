/// @file Is a polynomial positive on a whole interval? The test that keeps a distortion before its first
/// fold.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace ca2 {

namespace detail {

/// Positive on the interval whose Bernstein coefficients are `b`? De Casteljau halving; what is undecided
/// after `depth` halvings touches zero to rounding and counts as not positive.
template <std::size_t N>
bool bernstein_positive(std::array<double, N> b, int depth) {
  bool all = true;
  for (const double value : b) all = all && value > 0;
  if (all) return true;
  // The ends are values of the polynomial itself. The comparison is also false for NaN.
  if (!(b.front() > 0 && b.back() > 0) || depth == 0) return false;
  std::array<double, N> left;
  for (std::size_t i = 0; i < N; ++i) {
    left[i] = b[0];
    for (std::size_t j = 0; j + 1 < N - i; ++j) b[j] = 0.5 * (b[j] + b[j + 1]);
  }
  // What is left in b is the right half: b[j] was last touched at round N - 1 - j.
  return bernstein_positive(left, depth - 1) && bernstein_positive(b, depth - 1);
}

}  // namespace detail

/// Is c[0] + c[1] t + ... + c[N-1] t^(N-1) > 0 for every t in [0, end]? Exact up to rounding. A polynomial in
/// Bernstein form lies in the hull of its coefficients, so that far from a root this is N (N - 1) / 2
/// additions and N comparisons: cheap enough for every single projection, with nothing cached. Most are
/// further still: what the negative terms take away at the end does not use up c[0].
template <std::size_t N>
bool positive_up_to(const std::array<double, N>& c, double end) {
  double least = 0;
  for (std::size_t i = N - 1; i > 0; --i) least = (least + std::min(c[i], 0.0)) * end;
  if (c[0] + least > 0) return true;
  std::array<double, N> b;
  double power = 1;     // end^i
  double binomial = 1;  // N - 1 over i
  for (std::size_t i = 0; i < N; ++i) {
    b[i] = c[i] * power / binomial;
    power *= end;
    binomial = binomial * static_cast<double>(N - 1 - i) / static_cast<double>(i + 1);
  }
  for (std::size_t round = 1; round < N; ++round) {
    for (std::size_t i = N - 1; i >= round; --i) b[i] += b[i - 1];
  }
  return detail::bernstein_positive(b, 40);
}

}  // namespace ca2
