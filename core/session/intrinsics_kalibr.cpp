// Kalibr's camchain: intrinsics in an order that depends on the camera model, then a distortion model.
#include "core/session/intrinsics_nodes.h"

namespace ca2 {

Result<Camera> read_kalibr_camera(IntrinsicsNodes& nodes, const YAML::Node& camera) {
  const YAML::Node model_node = nodes.need(camera, {"camera_model"});
  const YAML::Node distortion_node = IntrinsicsNodes::find(camera, {"distortion_model"});
  const YAML::Node coefficients_node = IntrinsicsNodes::find(camera, {"distortion_coeffs"});
  const std::string model = IntrinsicsNodes::text(model_node);
  const std::string distortion =
      distortion_node.IsDefined() ? IntrinsicsNodes::text(distortion_node) : std::string("none");
  const YAML::Node intrinsics_node = nodes.need(camera, {"intrinsics"});
  const std::vector<double> intrinsics = nodes.numbers(intrinsics_node, "intrinsics");
  const std::vector<double> coefficients = nodes.numbers(coefficients_node, "distortion_coeffs");
  const YAML::Node resolution = nodes.need(camera, {"resolution"});
  int size[2] = {0, 0};
  if (resolution.IsDefined()) {
    if (resolution.IsSequence() && resolution.size() == 2) {
      size[0] = nodes.pixels(resolution[0], "the width");
      size[1] = nodes.pixels(resolution[1], "the height");
    } else {
      nodes.add(resolution, "resolution is not [width, height]");
    }
  }

  const bool sphere = model == "ds";
  if (model_node.IsDefined() && model != "pinhole" && !sphere) {
    nodes.add(model_node, "camera model '" + model + "' is not supported",
              "use pinhole-radtan, pinhole-equi or ds-none when calibrating with Kalibr");
    return fail(ErrorCode::config, nodes.problems);
  }
  if (intrinsics_node.IsDefined() && intrinsics.size() != (sphere ? 6u : 4u)) {
    nodes.add(intrinsics_node, sphere ? "intrinsics of ds are 6 numbers: xi, alpha, fu, fv, pu, pv"
                                      : "intrinsics of pinhole are 4 numbers: fu, fv, pu, pv");
  }
  const bool none = distortion == "none";
  const bool known = none || (!sphere && (distortion == "radtan" || distortion == "equidistant"));
  if (!known) {
    nodes.add(distortion_node,
              "distortion model '" + distortion + "' with camera model '" + model + "' is not supported",
              "radtan, equidistant and none are for pinhole, none for ds");
  } else if (none ? !coefficients.empty() : coefficients.size() != 4) {
    nodes.add(coefficients_node.IsDefined() ? coefficients_node : camera,
              "distortion model '" + distortion + "' has " + (none ? "no" : "4") + " coefficients, not " +
                  std::to_string(coefficients.size()));
  }
  if (!nodes.problems.empty()) return fail(ErrorCode::config, nodes.problems);

  if (sphere) {
    return nodes.finish(
        intrinsics_node, "double_sphere",
        {intrinsics[2], intrinsics[3], intrinsics[4], intrinsics[5], intrinsics[0], intrinsics[1]}, size[0],
        size[1]);
  }
  std::vector<double> parameters = intrinsics;
  parameters.insert(parameters.end(), coefficients.begin(), coefficients.end());
  if (none) parameters.resize(8, 0);
  return nodes.finish(intrinsics_node, distortion == "equidistant" ? "kannala_brandt" : "pinhole_radtan",
                      parameters, size[0], size[1]);
}

}  // namespace ca2
