/// @file Values as text for files that are read again: exact, and the same in every locale.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

namespace ca2 {

/// 17 significant digits: reading gives the same bits back. Not finite: YAML's .nan, .inf, -.inf.
std::string exact(double value);
/// "[a, b, c]" of exact numbers.
std::string exact_list(const double* values, std::size_t count);
template <class Derived>
std::string exact_list(const Eigen::MatrixBase<Derived>& vector) {
  const Eigen::VectorXd values = vector;
  return exact_list(values.data(), static_cast<std::size_t>(values.size()));
}

/// A YAML scalar that reads as this very text: plain where that is safe, in double quotes otherwise.
std::string yaml_string(std::string_view text);

}  // namespace ca2
