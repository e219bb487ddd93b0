// models.def, expanded twice: the functions' declarations, and the table of what they return.
#include <array>

#include "core/camera/camera_model.h"

namespace ca2 {

#define CA2_CAMERA_MODEL(name) const CameraModel& name##_model();
#include "core/camera/models.def"
#undef CA2_CAMERA_MODEL

std::span<const CameraModel* const> camera_models() {
#define CA2_CAMERA_MODEL(name) &name##_model(),
  static const auto models = std::to_array<const CameraModel*>({
#include "core/camera/models.def"
  });
#undef CA2_CAMERA_MODEL
  return models;
}

const CameraModel* find_camera_model(std::string_view name) {
  for (const CameraModel* model : camera_models()) {
    if (model->name() == name) return model;
  }
  return nullptr;
}

}  // namespace ca2
