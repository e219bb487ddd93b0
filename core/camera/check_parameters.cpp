#include "core/camera/check_parameters.h"

#include <cmath>

namespace ca2 {

std::optional<std::string> common_invalid(const CameraModel& model, const CameraParameters& parameters) {
  const auto names = model.parameter_names();
  const int most = static_cast<int>(names.size());
  const int least = most - model.optional_parameters();
  const int count = static_cast<int>(parameters.size());
  if (count < least || count > most) {
    std::string list;
    for (const std::string_view name : names) list += (list.empty() ? "" : " ") + std::string(name);
    return std::string(model.name()) + " has " + (least < most ? std::to_string(least) + " or " : "") +
           std::to_string(most) + " parameters (" + list + "), not " + std::to_string(count);
  }
  for (int i = 0; i < count; ++i) {
    if (!std::isfinite(parameters[i])) return std::string(names[i]) + " is not a finite number";
  }
  for (int i = 0; i < 2; ++i) {
    if (parameters[i] <= 0) return std::string(names[i]) + " is not positive";
  }
  return std::nullopt;
}

}  // namespace ca2
