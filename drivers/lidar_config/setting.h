/// @file What is wanted of a sensor, and what that would change.
#pragma once

#include <string>
#include <vector>

namespace ca2 {

/// A setting by the vendor's name. Values are text as a person writes it: 1024x10, 7502, [0, 360000].
struct Setting {
  std::string key;
  std::string value;
};

/// A setting the sensor has otherwise than wanted.
struct SettingChange {
  std::string key;  ///< as this sensor's firmware calls it
  std::string from, to;
};

}  // namespace ca2
