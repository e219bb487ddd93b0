#include "core/session/calibration.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  Calibration c;
  c.software = "ca2";
  c.method = "joint";
  CalibratedTransform transform;
  transform.parent = "left";
  transform.child = "top";
  transform.T_parent_child = Pose::from_quaternion({0.5, -0.5, 0.5, 0.5}, {0.1, 0.2, 0.3});
  transform.covariance.setIdentity();
  c.transforms = {transform};
  CalibratedCamera camera;
  camera.camera.model = find_camera_model("double_sphere");
  camera.camera.parameters.resize(6);
  camera.camera.parameters << 300, 300, 320, 240, -0.2, 0.5;
  camera.sigma = {1, 1, 0, 0, 0, 0};
  c.cameras["left"] = camera;
  c.lidars["top"] = {0.003, 0.001, 0.011, true};
  c.observability = {"weak", "rotation: about z", 12.5};
  c.validation.outline_offset = 0.002;
  c.views = {{1, true, "", 0.1, 0.01}, {2, false, "far \"off\"", 0.1, 0.01}};
  return {to_yaml(c), to_yaml(Calibration{}), to_json(c)};
}

}  // namespace ca2::fuzz

/// Every error has a place; whatever is read can be written in both forms and read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ca2::fuzz::require;
  const auto result = ca2::parse_calibration(std::string(reinterpret_cast<const char*>(data), size), "input");
  if (!result) {
    require(!result.error().problems.empty(), "an error without a problem");
    for (const ca2::Problem& problem : result.error().problems) require(!problem.where.empty(), "no place");
    return 0;
  }
  require(!ca2::to_json(*result).empty(), "no JSON");
  const auto again = ca2::parse_calibration(ca2::to_yaml(*result), "again");
  require(again.has_value(), "what was written cannot be read");
  require(again->transforms.size() == result->transforms.size(), "transforms got lost");
  for (std::size_t i = 0; i < result->transforms.size(); ++i) {
    require(again->transforms[i].T_parent_child.R == result->transforms[i].T_parent_child.R,
            "a rotation changed");
  }
  return 0;
}
