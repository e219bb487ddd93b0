#include "core/export/distortion.h"

#include "core/export/selection.h"

namespace ca2 {

Result<OpencvDistortion> opencv_distortion(const Camera& camera, const std::string& format) {
  const std::string_view model = camera.model->name();
  std::vector<double> coefficients(camera.parameters.begin() + 4, camera.parameters.end());
  if (model == "pinhole_radtan") {
    coefficients.resize(5, 0);  // plumb_bob has five: a k3 that is not there is 0
    return OpencvDistortion{"plumb_bob", false, coefficients};
  }
  if (model == "pinhole_rational") return OpencvDistortion{"rational_polynomial", false, coefficients};
  if (model == "kannala_brandt") return OpencvDistortion{"equidistant", true, coefficients};
  return inexpressible(format, "it has no camera model like " + std::string(model),
                       "calibrate with kannala_brandt, or use --format kalibr or json");
}

}  // namespace ca2
