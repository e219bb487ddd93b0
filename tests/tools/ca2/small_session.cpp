#include "tests/tools/ca2/small_session.h"

#include <fstream>
#include <iterator>

namespace ca2::test {
namespace {

namespace fs = std::filesystem;

// Near, well tilted boards in an almost empty room: the answer is good to a millimetre, and quickly made.
constexpr const char* scenario = R"(version: 1
seed: 5
board:
  type: checkerboard
  columns: 8
  rows: 5
  square: 0.088
  outline: {width: 0.841, height: 0.594, center: [0, 0]}
cameras:
  front:
    frame: front_camera_optical
    image_size: [640, 480]
    intrinsics: {model: pinhole_radtan, parameters: [518, 517.5, 318, 243, -0.12, 0.09, 0, 0]}
lidars:
  puck: {frame: velodyne, model: VLP-16}
truth:
  extrinsics:
    - parent: front
      child: puck
      translation: [0.035, -0.137, -0.096]
      rotation: {x: 0.7193, y: 0.0034, z: -0.0149, w: 0.6945}
views: {count: 8, distance: [1.5, 2.5], tilt: [0.2, 0.9], roll: 0.7, min_rings: 5, min_returns: 80}
scene: {size: [7, 8, 3.0], rig_height: 1.1, furniture: 3}
noise:
  cameras: {sigma: 0.004, blur: 0.6}
  lidars: {range_sigma: 0.008, sweeps: 3}
)";

/// Lives as long as the process.
const fs::path& original() {
  static const TemporaryDirectory directory;
  static const fs::path made = [] {
    write_bytes(directory / "scenario.yaml", scenario);
    const Outcome simulated =
        run_ca2({"simulate", directory / "scenario.yaml", "--output", directory / "session"});
    if (simulated.status != 0) throw std::runtime_error(simulated.errors);
    const Outcome solved = run_ca2({"solve", directory / "session"});
    if (solved.status != 0) throw std::runtime_error(solved.errors);
    fs::remove(directory / "session" / "result.yaml");
    return directory / "session";
  }();
  return made;
}

}  // namespace

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_bytes(const fs::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << content;
}

void SmallSession::SetUp() {
  fs::copy(original(), session, fs::copy_options::recursive);
}

fs::path SmallSession::view_file(int view, const std::string& name) const {
  return session / "views" / ("00000" + std::to_string(view)) / name;
}

void SmallSession::edit_rig(const std::string& from, const std::string& to) const {
  std::string text = bytes_of(session / "session.yaml");
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  write_bytes(session / "session.yaml", text.replace(at, from.size(), to));
}

Outcome SmallSession::solve(const std::vector<std::string>& options) const {
  std::vector<std::string> arguments{"solve", session};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_ca2(arguments);
}

}  // namespace ca2::test
