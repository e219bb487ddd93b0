/// Kalibr's camchain: cameras in a chain, each relative to the one before.
#include "core/export/selection.h"
#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

struct KalibrCamera {
  std::string model, distortion;
  std::vector<double> intrinsics, coefficients;
};

Result<KalibrCamera> kalibr_camera(const std::string& name, const Camera& camera) {
  const std::vector<double> p(camera.parameters.begin(), camera.parameters.end());
  const std::string_view model = camera.model->name();
  const std::vector<double> pinhole(p.begin(), p.begin() + 4);
  if (model == "double_sphere") return KalibrCamera{"ds", "none", {p[4], p[5], p[0], p[1], p[2], p[3]}, {}};
  const std::vector<double> four(p.begin() + 4, p.begin() + 8);
  if (model == "kannala_brandt") return KalibrCamera{"pinhole", "equidistant", pinhole, four};
  if (model == "pinhole_radtan" && (p.size() == 8 || p[8] == 0))
    return KalibrCamera{"pinhole", "radtan", pinhole, four};
  return inexpressible("kalibr",
                       "camera '" + name + "' is " + std::string(model) +
                           (model == "pinhole_radtan" ? " with k3, and radtan has only k1 k2 p1 p2"
                                                      : ", and the camchain has no such model"),
                       "calibrate with kannala_brandt, double_sphere or pinhole_radtan without k3");
}

std::string matrix(const std::string& name, const Pose& T) {
  std::string out = "  " + name + ":\n";
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector4d row(T.R(i, 0), T.R(i, 1), T.R(i, 2), T.t(i));
    out += "  - " + exact_list(row) + "\n";
  }
  return out + "  - [0, 0, 0, 1]\n";
}

}  // namespace

Result<ExportFiles> export_kalibr(const ExportRequest& request) {
  const auto cameras = select_cameras(request, "kalibr");
  if (!cameras) return fail(cameras.error());
  std::string out = hash_comments(request);
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    const ExportCamera& selected = (*cameras)[i];
    const Camera& camera = selected.calibrated->camera;
    const auto kalibr = kalibr_camera(selected.name, camera);
    if (!kalibr) return fail(kalibr.error());
    out += "# camera " + selected.name + "\ncam" + std::to_string(i) + ":\n";
    std::string others;
    for (std::size_t k = 0; k < cameras->size(); ++k) {
      if (k != i) others += (others.empty() ? "" : ", ") + std::to_string(k);
    }
    out += "  cam_overlaps: [" + others + "]\n";
    out += "  camera_model: " + kalibr->model + "\n";
    out += "  intrinsics: " + exact_list(kalibr->intrinsics.data(), kalibr->intrinsics.size()) + "\n";
    out += "  distortion_model: " + kalibr->distortion + "\n";
    out +=
        "  distortion_coeffs: " + exact_list(kalibr->coefficients.data(), kalibr->coefficients.size()) + "\n";
    out += "  resolution: [" + std::to_string(camera.width) + ", " + std::to_string(camera.height) + "]\n";
    out += "  rostopic: /" + selected.name + "/image_raw\n";
    if (i > 0) {
      const auto link = request.frames.between(request.frames.frame_of(selected.name),
                                               request.frames.frame_of((*cameras)[i - 1].name));
      if (!link) return fail(link.error());
      out += "  # points of the camera before to this one\n" + matrix("T_cn_cnm1", link->T);
    }
    const bool one = selected.transforms.size() == 1;
    for (const ExportTransform& t : selected.transforms) {
      out +=
          "  # not Kalibr's: points of " + t.child + " to this camera (" + sigma_text(t.connection) + ")\n";
      out += matrix(one ? "T_cam_lidar" : yaml_string("T_cam_" + t.child), t.connection.T);
    }
  }
  return ExportFiles{{"camchain.yaml", out}};
}

}  // namespace ca2
