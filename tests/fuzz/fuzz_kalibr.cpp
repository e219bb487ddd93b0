#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/ca2/kalibr_rig.h"

namespace ca2::fuzz {

/// A target and a camchain, a zero byte between them.
std::vector<std::string> seeds() {
  const std::string none(1, '\0');
  return {
      "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088  #m\ntagSpacing: 0.3\n" + none +
          "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [-0.1, 0.02, 0.001, 0]\n  distortion_model: "
          "radtan\n  intrinsics: [460, 461, 320, 240]\n  resolution: [640, 480]\ncam1:\n  T_cn_cnm1:\n"
          "  - [0, -1, 0, -0.11]\n  - [1, 0, 0, 0.02]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n"
          "  camera_model: ds\n  intrinsics: [-0.2, 0.5, 300, 300, 320, 240]\n  resolution: [640, 480]\n",
      "target_type: checkerboard\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\ncolSpacingMeters: "
      "0.06" +
          none + "cam0: {camera_model: pinhole, intrinsics: [1, 1, 0, 0], resolution: [9, 9]}\n"};
}

}  // namespace ca2::fuzz

/// A rig that is made of them is one that a session could have.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  static const fuzz::File target("target.yaml"), camchain("camchain.yaml");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(text.find('\0'), size);
  target.write(text.substr(0, end));
  camchain.write(text.substr(std::min(end + 1, size)));
  const auto rig = kalibr_rig(target.path, camchain.path, {"top"});
  if (!rig) {
    fuzz::require(!rig.error().problems.empty(), "an error without a problem");
    return 0;
  }
  fuzz::require(parse_rig(write_rig(*rig), "again").has_value(), "what was written cannot be read");
  return 0;
}
