/// @file Checked access to the YAML of intrinsics files: every miss becomes a Problem with its place.
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/types/result.h"

namespace ca2 {

struct IntrinsicsNodes {
  std::string file;
  std::vector<Problem> problems;

  void add(const YAML::Node& node, std::string what, std::string hint = {});

  /// The first of `keys` that the map has; an undefined node when it has none or is no map.
  static YAML::Node find(const YAML::Node& map, std::initializer_list<const char*> keys);
  /// As find, but a miss is a problem.
  YAML::Node need(const YAML::Node& map, std::initializer_list<const char*> keys);

  /// A finite number; a problem and 0 otherwise.
  double number(const YAML::Node& node, const std::string& name);
  /// A list of at most 64 finite numbers, plain or as the `data` of a matrix whose rows x cols must fit.
  std::vector<double> numbers(const YAML::Node& node, const std::string& name);
  /// A picture's width or height, px.
  int pixels(const YAML::Node& node, const std::string& name);
  /// A text; empty when there is none.
  static std::string text(const YAML::Node& node);

  /// The camera, if there is no problem so far and the model takes the parameters.
  Result<Camera> finish(const YAML::Node& node, std::string_view model, const std::vector<double>& parameters,
                        int width, int height);
};

/// One camera of a Kalibr camchain (or a file with its keys at the root).
Result<Camera> read_kalibr_camera(IntrinsicsNodes& nodes, const YAML::Node& camera);

}  // namespace ca2
