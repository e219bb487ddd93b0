#include "core/session/intrinsics_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  return {
      "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix: {rows: 3, cols: 3, data: [500, "
      "0, "
      "320, 0, 500, 240, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, "
      "data: [-0.1, 0.02, 0, 0, 0]}\nbinning_x: 1\nroi: {x_offset: 0, width: 640}\n",
      "width: 64\nheight: 48\ndistortion_model: equidistant\nD: [0.1, 0, 0, 0]\n"
      "K: [50, 0, 32, 0, 50, 24, 0, 0, 1]\n",
      "cam0: {camera_model: pinhole, distortion_model: radtan, distortion_coeffs: [-0.1, 0, 0, 0], "
      "intrinsics: "
      "[460, 461, 320, 240], resolution: [640, 480]}\n",
      "camera_model: ds\nintrinsics: [-0.2, 0.5, 300, 300, 320, 240]\nresolution: [640, 480]\n",
      "%YAML:1.0\n---\nimage_width: 64\nimage_height: 48\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   "
      "cols: 3\n"
      "   dt: d\n   data: [ 50., 0., 32., 0., 50., 24., 0., 0., 1. ]\ndistortion_coefficients: "
      "!!opencv-matrix\n"
      "   rows: 8\n   cols: 1\n   dt: d\n   data: [ .1, 0., 0., 0., 0., 0., 0., 0. ]\n"};
}

}  // namespace ca2::fuzz

/// What is read is a camera that its model takes for one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ca2::fuzz::require;
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const char* camera : {"", "cam0"}) {
    const auto read = ca2::parse_intrinsics(text, "input", camera);
    if (!read) {
      require(!read.error().problems.empty(), "an error without a problem");
      continue;
    }
    require(read->model && !read->model->invalid(read->parameters), "a camera that is none");
    require(read->width > 0 && read->height > 0, "a picture of no size");
    (void)read->project({0.1, -0.2, 1});
  }
  return 0;
}
