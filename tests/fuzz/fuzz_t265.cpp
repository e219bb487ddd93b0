#include <algorithm>
#include <variant>

#include "drivers/camera/t265/calibration.h"
#include "drivers/camera/t265/messages.h"
#include "tests/drivers/camera/t265/golden.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  using namespace t265;
  std::vector<std::string> out;
  const auto add = [&](char kind, std::string_view hex) {
    const Bytes bytes = golden::bytes(hex);
    out.push_back(kind + std::string(bytes.begin(), bytes.end()));
  };
  add(0, golden::picture_right);
  add(0, golden::acceleration);
  add(0, golden::stopped);
  add(1, "10 00 00 00 02 00 00 00 01 02 03 04 05 06 07 08");
  add(2, golden::device_info);
  add(2, golden::streams);
  add(2, golden::intrinsics_left);
  add(2, golden::extrinsics_left);
  add(3, std::string(golden::intrinsics_left) + " " + std::string(golden::extrinsics_left));
  return out;
}

}  // namespace ca2::fuzz

/// Whatever arrives: a picture lies inside its message, and what passes for a calibration is one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  using namespace ca2::t265;
  if (size == 0) return 0;
  const int kind = data[0] % 4;
  const ByteSpan bytes{data + 1, size - 1};
  if (kind == 0) {
    const StreamMessage message = parse_stream(bytes);
    if (const auto* picture = std::get_if<Picture>(&message)) {
      fuzz::require(!picture->pixels.empty(), "an empty picture");
      fuzz::require(picture->pixels.data() + picture->pixels.size() == data + size,
                    "pixels beyond the message");
    }
  } else if (kind == 1) {
    if (const auto response = parse_response(bytes)) {
      fuzz::require(response->body.size() + response_header == bytes.size(), "a body of another length");
    }
  } else if (kind == 2) {
    (void)parse_device_info(bytes);
    (void)parse_time(bytes);
    if (const auto streams = parse_streams(bytes)) {
      const Bytes again = request_streams(*streams);
      fuzz::require(again.size() == 8 + 12 * streams->size(), "streams do not survive");
    }
  } else if (bytes.size() == 48 + 49) {
    const auto in = parse_camera_intrinsics(bytes.first(48));
    const auto ex = parse_extrinsics(bytes.subspan(48));
    fuzz::require(in && ex, "whole messages are read");
    const FisheyeCalibration side{*in, *ex};
    if (const auto streams = camera_streams(side, side)) {
      const Pose& T = *(*streams)[1].T_first_this;
      fuzz::require((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12, "no rotation");
      fuzz::require(T.t.norm() < 1e-12, "one imager in two places");
      (void)(*streams)[0].intrinsics->project({0.1, 0.2, 1.0});
    }
  }
  return 0;
}
