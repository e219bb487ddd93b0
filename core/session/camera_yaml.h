/// @file A camera's model and parameters as YAML keys.
#pragma once

#include <optional>

#include "core/camera/camera_model.h"
#include "core/io/yaml_reader.h"

namespace ca2 {

/// The model that a node names; an unknown name is reported with the nearest known one.
const CameraModel* read_model(YamlReader& reader, const YamlNode* node);

/// The parameters of a model, judged by it. Their names and counts are in the messages.
std::optional<CameraParameters> read_parameters(YamlReader& reader, const YamlNode* node,
                                                const CameraModel& model);

}  // namespace ca2
