/// @file A camera's GenICam features by what they are for, whatever its vendor calls them.
#pragma once

#include <arv.h>

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// The purposes of features.def.
enum class Feature {
#define CA2_FEATURE(purpose, ...) purpose,
#include "drivers/camera/aravis/features.def"
#undef CA2_FEATURE
};

struct Limits {
  double least = 0, most = 0;
};

/// Features of one device. Not for two threads at once: Aravis evaluates a camera's description without
/// locks. Every access may ask the camera over the network: 2.5 s where it does not answer.
class Features {
 public:
  explicit Features(ArvDevice* device) : device_(device) {}

  bool has(const char* name) const;
  /// The camera's name for it; nullptr when it has none.
  const char* name(Feature feature) const;
  bool has(Feature feature) const { return name(feature) != nullptr; }

  // Integer, float, enumeration or boolean, as the camera has it. An error names the feature.
  std::optional<double> number(const char* name) const;
  std::optional<Limits> limits(const char* name) const;
  std::optional<std::string> text(const char* name) const;
  Result<void> set_number(const char* name, double value) const;
  Result<void> set_text(const char* name, const std::string& value) const;
  Result<void> set_boolean(const char* name, bool value) const;
  Result<void> execute(const char* name) const;

  /// An enumeration's entries that can be chosen now.
  std::vector<std::string> choices(const char* name) const;
  /// Sets an enumeration to the first of the entries that it offers; false where it offers none.
  bool set_first_choice(const char* name, std::initializer_list<const char*> entries) const;

 private:
  ArvDevice* device_;
};

}  // namespace ca2
