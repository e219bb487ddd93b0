#include "tools/ca2/bench_pictures.h"

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

namespace ca2 {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// The lens' blur, the sensor's noise, 8 bits.
Image photographed(const cv::Mat& scene, double sigma, double noise, Random& random) {
  cv::Mat grey;
  scene.convertTo(grey, CV_32F);
  if (sigma > 0) cv::GaussianBlur(grey, grey, {}, sigma);
  std::normal_distribution<float> normal(0, static_cast<float>(noise));
  Image image{grey.cols, grey.rows, 1, 8, {}};
  image.bytes.reserve(grey.total());
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      image.bytes.push_back(cv::saturate_cast<std::uint8_t>(grey.at<float>(y, x) + normal(random)));
    }
  }
  return image;
}

cv::Mat texture(int w, int h, Random& random) {
  cv::Mat noise(h, w, CV_32F);
  std::normal_distribution<float> normal;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) noise.at<float>(y, x) = normal(random);
  }
  const double sigma = uniform(random, 0.8, 3);
  cv::GaussianBlur(noise, noise, {}, sigma);
  return noise * (60 * 3.5 * sigma) + 128;
}

cv::Mat foliage(int w, int h, Random& random) {
  cv::Mat scene(h, w, CV_8U, cv::Scalar(60));
  for (int i = 0; i < w * h / 250; ++i) {
    const cv::Point centre(static_cast<int>(uniform(random, 0, w)), static_cast<int>(uniform(random, 0, h)));
    const cv::Size axes(static_cast<int>(uniform(random, 4, 28)), static_cast<int>(uniform(random, 2, 10)));
    cv::ellipse(scene, centre, axes, uniform(random, 0, 180), 0, 360, uniform(random, 20, 235), cv::FILLED);
  }
  return scene;
}

cv::Mat keyboard(int w, int h, Random& random) {
  cv::Mat scene(h, w, CV_8U, cv::Scalar(40));
  const int pitch = static_cast<int>(uniform(random, 24, 70));
  for (int row = 0, y = 4; y + pitch < h; y += pitch, ++row) {
    for (int x = 4 + row * pitch / 4 % pitch; x + pitch < w; x += pitch) {
      cv::rectangle(scene, cv::Rect(x, y, pitch - 4, pitch - 4), 200, cv::FILLED);
      const std::string letter(1, static_cast<char>('A' + static_cast<int>(uniform(random, 0, 26))));
      cv::putText(scene, letter, {x + pitch / 5, y + 3 * pitch / 4}, cv::FONT_HERSHEY_SIMPLEX, pitch / 45.0,
                  30, std::max(1, pitch / 20));
    }
  }
  return scene;
}

cv::Mat blinds(int w, int h, Random& random) {
  cv::Mat scene(h, w, CV_8U, cv::Scalar(220));
  const int pitch = static_cast<int>(uniform(random, 8, 40));
  for (int y = 0; y < h; y += pitch) {
    cv::line(scene, {0, y}, {w, y + static_cast<int>(0.05 * w)}, 60, std::max(1, pitch / 3));
  }
  for (int x = w / 8; x < w; x += w / 4) cv::line(scene, {x, 0}, {x, h}, 120, 3);
  return scene;
}

cv::Mat windows(int w, int h, Random& random) {
  cv::Mat scene(h, w, CV_8U, cv::Scalar(150));
  const int px = static_cast<int>(uniform(random, 30, 110));
  const int py = static_cast<int>(uniform(random, 40, 130));
  for (int y = 6; y + py < h; y += py) {
    for (int x = 6; x + px < w; x += px) {
      cv::rectangle(scene, cv::Rect(x, y, px * 2 / 3, py * 2 / 3), uniform(random, 20, 235), cv::FILLED);
      cv::line(scene, {x + px / 3, y}, {x + px / 3, y + py * 2 / 3}, 230, 2);
    }
  }
  return scene;
}

cv::Mat floor(int w, int h, Random& random) {
  const double size = uniform(random, 0.05, 0.3);
  const double turn = uniform(random, 0, M_PI);
  cv::Mat scene(h, w, CV_8U);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      // A plane 1.5 m below a camera with a focal length of the picture's width.
      const double down = (y - 0.15 * h) / w;
      const double z = 1.5 / std::max(down, 0.02);
      const double side = (x - 0.5 * w) / w * z;
      const double u = std::cos(turn) * side + std::sin(turn) * z;
      const double v = std::cos(turn) * z - std::sin(turn) * side;
      const bool black =
          (static_cast<long>(std::floor(u / size)) + static_cast<long>(std::floor(v / size))) % 2 == 0;
      scene.at<std::uint8_t>(y, x) = down < 0.02 ? 140 : (black ? 40 : 200);
    }
  }
  return scene;
}

/// Lays the board over a scene, 3 x 3 samples a pixel.
void lay_board(cv::Mat& scene, const Board& board, const Camera& camera, const Pose& T_camera_board) {
  const Pose T_board_camera = T_camera_board.inverse();
  const Eigen::Vector2d half =
      0.5 * board.type->pattern_size(board) + Eigen::Vector2d::Constant(board.square / 2);
  for (int y = 0; y < scene.rows; ++y) {
    for (int x = 0; x < scene.cols; ++x) {
      const auto board_point = [&](double px, double py) -> std::optional<Eigen::Vector2d> {
        const auto bearing = camera.unproject({px, py});
        if (!bearing) return std::nullopt;
        const Eigen::Vector3d d = T_board_camera.R * *bearing;
        if (d.z() <= 1e-6) return std::nullopt;
        const Eigen::Vector3d p = T_board_camera.t - T_board_camera.t.z() / d.z() * d;
        return Eigen::Vector2d(p.x(), p.y());
      };
      const auto centre = board_point(x, y);
      if (!centre || (centre->cwiseAbs() - half).maxCoeff() > board.square) continue;
      double sum = 0;
      for (int k = 0; k < 9; ++k) {
        const auto p = board_point(x + (k % 3 - 1) / 3.0, y + (k / 3 - 1) / 3.0);
        const bool on = p && (p->cwiseAbs() - half).maxCoeff() <= 0;
        sum += !on ? scene.at<std::uint8_t>(y, x) : (board.type->black(board, *p) ? 35 : 210);
      }
      scene.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(sum / 9));
    }
  }
}

Camera camera_of(const char* model, std::initializer_list<double> parameters, int width, int height) {
  Camera camera{find_camera_model(model), {}, width, height};
  camera.parameters.resize(static_cast<Eigen::Index>(parameters.size()));
  std::copy(parameters.begin(), parameters.end(), camera.parameters.data());
  return camera;
}

}  // namespace

Board bench_board() {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = 8;
  board.rows = 6;
  board.square = 0.04;
  return board;
}

std::vector<Board> bench_boards() {
  std::vector<Board> boards{bench_board()};
  Board charuco = bench_board();
  charuco.type = find_board_type("charuco");
  charuco.columns = 9;
  charuco.rows = 7;
  charuco.marker = 0.03;
  boards.push_back(charuco);
  Board aprilgrid;
  aprilgrid.type = find_board_type("aprilgrid");
  aprilgrid.columns = 6;
  aprilgrid.rows = 5;
  aprilgrid.square = 0.045;
  aprilgrid.spacing = 0.3;
  boards.push_back(aprilgrid);
  std::erase_if(boards, [](const Board& board) { return board.type == nullptr; });
  return boards;
}

std::vector<BenchCamera> bench_cameras() {
  return {{"848x800 wide",
           camera_of("kannala_brandt", {286, 286, 424, 400, -0.007, 0.044, -0.042, 0.007}, 848, 800),
           {1.0, 0.3, 1.0}},
          {"1388x1038",
           camera_of("pinhole_radtan", {1250, 1250, 693.5, 518.5, -0.1, 0.05, 0, 0}, 1388, 1038),
           {0.3, 0.7, 3.0}},
          {"2048x1536",
           camera_of("pinhole_radtan", {1700, 1700, 1023.5, 767.5, -0.2, 0.1, 0, 0}, 2048, 1536),
           {0.35, 0.7, 4.0}}};
}

Pose random_board_pose(const Board& board, const Camera& camera, const BoardPlaces& places, Random& random) {
  for (;;) {
    const double off = uniform(random, 0, places.off_axis);
    const double around = uniform(random, 0, 2 * M_PI);
    const Eigen::Vector3d bearing(std::sin(off) * std::cos(around), std::sin(off) * std::sin(around),
                                  std::cos(off));
    const double axis = uniform(random, 0, 2 * M_PI);
    const Eigen::Vector3d tilt =
        uniform(random, 0, M_PI / 3) * Eigen::Vector3d(std::cos(axis), std::sin(axis), 0);
    const Eigen::Matrix3d R =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), bearing).toRotationMatrix() *
        so3_exp(tilt) * so3_exp({0, 0, uniform(random, -M_PI, M_PI)});
    const Pose T_camera_board{R, bearing * uniform(random, places.nearest, places.farthest)};
    bool whole = true;
    for (const Eigen::Vector2d& p : board.type->corners(board)) {
      const auto pixel = camera.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0));
      whole = whole && pixel && camera.contains(*pixel, 12);
    }
    if (whole) return T_camera_board;
  }
}

Image board_picture(const Board& board, const Camera& camera, const Pose& T_camera_board, Random& random) {
  cv::Mat scene = windows(camera.width, camera.height, random);
  lay_board(scene, board, camera, T_camera_board);
  return photographed(scene, uniform(random, 0.4, 1.2), 1.8, random);
}

std::vector<BenchPicture> board_pictures(const std::string& kind, const Board& board, const Camera& camera,
                                         const BoardPlaces& places, int count, Random& random) {
  std::vector<BenchPicture> pictures;
  for (int i = 0; i < count; ++i) {
    const Pose T_camera_board = random_board_pose(board, camera, places, random);
    pictures.push_back({kind, board_picture(board, camera, T_camera_board, random)});
  }
  return pictures;
}

std::vector<BenchPicture> hard_pictures(int width, int height, int each, Random& random) {
  const std::pair<const char*, std::function<cv::Mat(int, int, Random&)>> kinds[] = {
      {"texture", texture}, {"foliage", foliage}, {"keyboard", keyboard},
      {"blinds", blinds},   {"windows", windows}, {"floor", floor}};
  std::vector<BenchPicture> pictures;
  for (const auto& [kind, draw] : kinds) {
    for (int i = 0; i < each; ++i) {
      pictures.push_back({kind, photographed(draw(width, height, random), 0.6, 1.8, random)});
    }
  }
  return pictures;
}

}  // namespace ca2
