#include "drivers/camera/aravis/features.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "drivers/camera/aravis/glib.h"

namespace ca2 {
namespace {

#define CA2_FEATURE(purpose, ...) constexpr const char* purpose##_names[] = {__VA_ARGS__};
#include "drivers/camera/aravis/features.def"
#undef CA2_FEATURE

std::span<const char* const> names_of(Feature feature) {
  switch (feature) {
#define CA2_FEATURE(purpose, ...) \
  case Feature::purpose:          \
    return purpose##_names;
#include "drivers/camera/aravis/features.def"
#undef CA2_FEATURE
  }
  return {};
}

tl::unexpected<Error> refused(const char* name, const GErrorHolder& error) {
  return fail(ErrorCode::unavailable, name, error.text());
}

}  // namespace

bool Features::has(const char* name) const {
  GErrorHolder error;
  return arv_device_get_feature(device_, name) && arv_device_is_feature_available(device_, name, error.out());
}

const char* Features::name(Feature feature) const {
  for (const char* candidate : names_of(feature)) {
    if (has(candidate)) return candidate;
  }
  return nullptr;
}

std::optional<double> Features::number(const char* name) const {
  GErrorHolder error;
  ArvGcNode* node = arv_device_get_feature(device_, name);
  double value = 0;
  if (ARV_IS_GC_FLOAT(node)) {
    value = arv_device_get_float_feature_value(device_, name, error.out());
  } else if (ARV_IS_GC_INTEGER(node) || ARV_IS_GC_ENUMERATION(node)) {
    value = static_cast<double>(arv_device_get_integer_feature_value(device_, name, error.out()));
  } else {
    return std::nullopt;
  }
  return error ? std::nullopt : std::optional(value);
}

std::optional<Limits> Features::limits(const char* name) const {
  GErrorHolder error;
  ArvGcNode* node = arv_device_get_feature(device_, name);
  Limits limits;
  if (ARV_IS_GC_FLOAT(node)) {
    arv_device_get_float_feature_bounds(device_, name, &limits.least, &limits.most, error.out());
  } else if (ARV_IS_GC_INTEGER(node)) {
    gint64 least = 0, most = 0;
    arv_device_get_integer_feature_bounds(device_, name, &least, &most, error.out());
    limits = {static_cast<double>(least), static_cast<double>(most)};
  } else {
    return std::nullopt;
  }
  return error ? std::nullopt : std::optional(limits);
}

std::optional<std::string> Features::text(const char* name) const {
  GErrorHolder error;
  const char* value = arv_device_get_string_feature_value(device_, name, error.out());
  return error || !value ? std::nullopt : std::optional<std::string>(value);
}

Result<void> Features::set_number(const char* name, double value) const {
  GErrorHolder error;
  if (ARV_IS_GC_FLOAT(arv_device_get_feature(device_, name))) {
    arv_device_set_float_feature_value(device_, name, value, error.out());
  } else {
    arv_device_set_integer_feature_value(device_, name, std::llround(value), error.out());
  }
  if (error) return refused(name, error);
  return {};
}

Result<void> Features::set_text(const char* name, const std::string& value) const {
  GErrorHolder error;
  arv_device_set_string_feature_value(device_, name, value.c_str(), error.out());
  if (error) return refused(name, error);
  return {};
}

Result<void> Features::set_boolean(const char* name, bool value) const {
  GErrorHolder error;
  arv_device_set_boolean_feature_value(device_, name, value, error.out());
  if (error) return refused(name, error);
  return {};
}

Result<void> Features::execute(const char* name) const {
  GErrorHolder error;
  arv_device_execute_command(device_, name, error.out());
  if (error) return refused(name, error);
  return {};
}

std::vector<std::string> Features::choices(const char* name) const {
  GErrorHolder error;
  guint count = 0;
  const GMemory<const char*> entries(
      arv_device_dup_available_enumeration_feature_values_as_strings(device_, name, &count, error.out()));
  if (error || !entries) return {};
  return {entries.get(), entries.get() + count};
}

bool Features::set_first_choice(const char* name, std::initializer_list<const char*> entries) const {
  if (!has(name)) return false;
  const std::vector<std::string> offered = choices(name);
  for (const char* entry : entries) {
    if (std::find(offered.begin(), offered.end(), entry) != offered.end()) {
      return set_text(name, entry).has_value();
    }
  }
  return false;
}

}  // namespace ca2
