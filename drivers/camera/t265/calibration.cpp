#include "drivers/camera/t265/calibration.h"

#include <cmath>

#include "core/types/text.h"

namespace ca2::t265 {
namespace {

constexpr int largest_side = 4096;        // px; the T265 has 848 x 800
constexpr double rotation_error = 1e-3;   // floats of a rotation are within 1e-6
constexpr double largest_baseline = 0.2;  // m; the imagers are 64 mm apart

Error wrong(const char* imager, const std::string& what) {
  return {ErrorCode::data, std::string("T265, ") + imager + " imager", "factory calibration: " + what,
          "give the intrinsics in the rig, or have them estimated"};
}

Result<Camera> camera(const char* imager, const CameraIntrinsics& in) {
  if (in.model != kannala_brandt4) {
    return fail(wrong(imager, formatted("distortion model %u is not Kannala-Brandt (4)", in.model)));
  }
  if (in.width < 1 || in.width > largest_side || in.height < 1 || in.height > largest_side) {
    return fail(wrong(imager, formatted("pictures of %u x %u", in.width, in.height)));
  }
  Camera out{find_camera_model("kannala_brandt"), CameraParameters(8), static_cast<int>(in.width),
             static_cast<int>(in.height)};
  const auto& k = in.coefficients;
  out.parameters << in.fx, in.fy, in.cx, in.cy, k[0], k[1], k[2], k[3];
  if (auto reason = out.model->invalid(out.parameters)) return fail(wrong(imager, *reason));
  return out;
}

/// T_pose_sensor.
Result<Pose> pose(const char* imager, const Extrinsics& in) {
  if (in.reference != Sensor::pose) {
    return fail(wrong(imager, formatted("extrinsics relative to sensor 0x%02x, not to 0x0a",
                                        static_cast<unsigned>(in.reference))));
  }
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix3f>(in.R.data()).cast<double>();
  const Eigen::Vector3d t = Eigen::Map<const Eigen::Vector3f>(in.t.data()).cast<double>();
  // Written so that NaN is refused too.
  const bool rotation =
      (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < rotation_error && R.determinant() > 0;
  if (!rotation) return fail(wrong(imager, "no rotation matrix"));
  if (!(t.norm() < largest_baseline)) {
    return fail(wrong(imager, formatted("%g m from the device's origin", t.norm())));
  }
  // From single precision to a rotation to the last bit.
  return Pose::from_quaternion(Eigen::Quaterniond(R), t);
}

}  // namespace

Result<std::vector<CameraStream>> camera_streams(const FisheyeCalibration& left,
                                                 const FisheyeCalibration& right) {
  const FisheyeCalibration* sides[] = {&left, &right};
  const char* names[] = {"left", "right"};
  std::vector<CameraStream> out;
  Pose T_pose_left;
  for (int i = 0; i < 2; ++i) {
    const auto intrinsics = camera(names[i], sides[i]->intrinsics);
    if (!intrinsics) return fail(intrinsics.error());
    const auto T_pose_this = pose(names[i], sides[i]->extrinsics);
    if (!T_pose_this) return fail(T_pose_this.error());
    if (i == 0) T_pose_left = *T_pose_this;
    CameraStream stream;
    stream.name = names[i];
    stream.width = intrinsics->width;
    stream.height = intrinsics->height;
    stream.format = "Y8";
    stream.intrinsics = *intrinsics;
    stream.T_first_this = i == 0 ? Pose{} : T_pose_left.inverse() * *T_pose_this;
    out.push_back(std::move(stream));
  }
  return out;
}

}  // namespace ca2::t265
