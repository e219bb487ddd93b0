#include "core/board/types/aprilgrid_tags.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

#include <algorithm>
#include <map>
#include <memory>
#include <opencv2/calib3d.hpp>

#include "core/board/detect/grey_at.h"

namespace ca2 {
namespace {

using Family = std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)>;
using Detector = std::unique_ptr<apriltag_detector_t, decltype(&apriltag_detector_destroy)>;

/// The library's own tags have a border of one cell.
Family make_family() {
  Family family(tag36h11_create(), &tag36h11_destroy);
  family->width_at_border = aprilgrid_cells;
  family->total_width = aprilgrid_cells + 2;
  for (std::uint32_t i = 0; i < family->nbits; ++i) {
    family->bit_x[i] += aprilgrid_border - 1;
    family->bit_y[i] += aprilgrid_border - 1;
  }
  return family;
}

using Tags = std::map<int, AprilTag>;  // by id

/// Where the lines through a's and through b's two points meet.
Eigen::Vector2d meet(const Eigen::Vector2d& a, const Eigen::Vector2d& along_a, const Eigen::Vector2d& b,
                     const Eigen::Vector2d& along_b) {
  Eigen::Matrix2d M;
  M << along_a, -along_b;
  return a + along_a * (M.inverse() * (b - a)).x();
}

/// The quadrilateral with every side moved outwards by `by` px.
std::array<Eigen::Vector2d, 4> widened(const std::array<Eigen::Vector2d, 4>& corners, double by) {
  std::array<Eigen::Vector2d, 4> start, direction;
  for (std::size_t i = 0; i < 4; ++i) {
    direction[i] = (corners[(i + 1) % 4] - corners[i]).normalized();
    // Clockwise in a picture with y down: outwards is to the left of the way.
    start[i] = corners[i] + by * Eigen::Vector2d(direction[i].y(), -direction[i].x());
  }
  std::array<Eigen::Vector2d, 4> result;
  for (std::size_t i = 0; i < 4; ++i) {
    result[i] = meet(start[(i + 3) % 4], direction[(i + 3) % 4], start[i], direction[i]);
  }
  return result;
}

/// Lightest of the 3 x 3 pixels around each: cuts the tags loose from the squares at their corners, with
/// which they would be one black thing where the crossing's pixel happens to be dark.
Image lightened(const Image& image) {
  Image rows = image, result = image;
  const std::size_t w = static_cast<std::size_t>(image.width), h = static_cast<std::size_t>(image.height);
  for (std::size_t y = 0; y < h; ++y) {
    const std::uint8_t* from = image.bytes.data() + y * w;
    for (std::size_t x = 1; x + 1 < w; ++x)
      rows.bytes[y * w + x] = std::max({from[x - 1], from[x], from[x + 1]});
  }
  for (std::size_t i = w; i + w < w * h; ++i) {
    result.bytes[i] = std::max({rows.bytes[i - w], rows.bytes[i], rows.bytes[i + w]});
  }
  return result;
}

/// Adds the tags of a picture that are not known yet; their sides are moved outwards by `widen` px.
void add_tags(const Board& board, const Image& image, double widen, Tags& tags) {
  const Family family = make_family();
  const Detector detector(apriltag_detector_create(), &apriltag_detector_destroy);
  detector->nthreads = 1;
  detector->quad_decimate = 1;
  apriltag_detector_add_family_bits(detector.get(), family.get(), 1);
  image_u8_t view{image.width, image.height, image.width, const_cast<std::uint8_t*>(image.bytes.data())};
  zarray_t* detections = apriltag_detector_detect(detector.get(), &view);
  Tags found;
  for (int i = 0; i < zarray_size(detections); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections, i, &detection);
    const int id = detection->id;
    if (id >= board.columns * board.rows) continue;
    AprilTag tag{id % board.columns, board.rows - 1 - id / board.columns, {}, detection->decision_margin};
    // From bottom left counter-clockwise, the centre of the first pixel at (0.5, 0.5).
    for (std::size_t k = 0; k < 4; ++k) {
      tag.corners[3 - k] = {detection->p[k][0] - 0.5, detection->p[k][1] - 0.5};
    }
    const auto [at, fresh] = found.emplace(id, tag);
    if (!fresh && tag.margin > at->second.margin) at->second = tag;
  }
  apriltag_detections_destroy(detections);
  for (auto& [id, tag] : found) {
    tag.corners = widened(tag.corners, widen);
    tags.emplace(id, tag);
  }
}

/// By how many quarter turns the tags are turned against the grid: generators differ. By the directions from
/// each tag to its neighbours; a tag alone counts as upright.
int quarter_turns(const Tags& tags) {
  std::array<double, 4> votes{};
  for (const auto& [id, tag] : tags) {
    for (const auto& [other_id, other] : tags) {
      const int dx = other.column - tag.column, dy = other.row - tag.row;
      if (std::abs(dx) + std::abs(dy) != 1) continue;
      const Eigen::Vector2d to = (other.centre() - tag.centre()).normalized();
      for (std::size_t k = 0; k < 4; ++k) {
        const auto corner = [k, &corners = tag.corners](std::size_t i) { return corners[(i + k) % 4]; };
        const Eigen::Vector2d x = (corner(1) - corner(0)).normalized(),
                              y = (corner(3) - corner(0)).normalized();
        votes[k] += to.dot(dx * x + dy * y);
      }
    }
  }
  return static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

/// Pixels of the grid's plane near some tags: places are in tags from the first tag's top left corner.
class LocalGrid {
 public:
  LocalGrid(const std::vector<const AprilTag*>& tags, double period) {
    std::vector<cv::Point2d> from, to;
    for (const AprilTag* tag : tags) {
      for (std::size_t k = 0; k < 4; ++k) {
        from.emplace_back(tag->column * period + (k == 1 || k == 2), tag->row * period + (k >= 2));
        to.emplace_back(tag->corners[k].x(), tag->corners[k].y());
      }
    }
    const cv::Mat H = cv::findHomography(from, to);
    valid_ = H.rows == 3;
    for (int i = 0; valid_ && i < 9; ++i) H_(i / 3, i % 3) = H.at<double>(i / 3, i % 3);
  }
  bool valid() const { return valid_; }
  Eigen::Vector2d pixel(double x, double y) const { return (H_ * Eigen::Vector3d(x, y, 1)).hnormalized(); }

 private:
  Eigen::Matrix3d H_ = Eigen::Matrix3d::Identity();
  bool valid_ = false;
};

/// Is there a crossing as the grid has it at a corner of a tag: the tag and the square across dark, the gaps
/// light?
bool is_crossing(const Image& image, const LocalGrid& grid, double x, double y, double inwards_x,
                 double inwards_y, double gap) {
  const double d = 0.3 * gap;
  const auto tag = grey_at(image, grid.pixel(x + d * inwards_x, y + d * inwards_y));
  const auto across = grey_at(image, grid.pixel(x - d * inwards_x, y - d * inwards_y));
  const auto beside = grey_at(image, grid.pixel(x - d * inwards_x, y + d * inwards_y));
  const auto below = grey_at(image, grid.pixel(x + d * inwards_x, y - d * inwards_y));
  constexpr double contrast = 15;  // grey levels
  return tag && across && beside && below && std::min(*beside, *below) > std::max(*tag, *across) + contrast;
}

/// Tags that could not be read, where their neighbours say they are and the picture shows their four
/// crossings: small or oblique ones, and those under a thumb.
void grow(const Board& board, const Image& image, Tags& tags) {
  const double period = 1 + board.spacing;
  for (bool grown = true; grown;) {
    grown = false;
    for (int id = 0; id < board.columns * board.rows; ++id) {
      if (tags.count(id)) continue;
      AprilTag tag{id % board.columns, board.rows - 1 - id / board.columns, {}, 0};
      std::vector<const AprilTag*> near;
      for (const auto& [other_id, other] : tags) {
        if (std::abs(other.column - tag.column) <= 1 && std::abs(other.row - tag.row) <= 1)
          near.push_back(&other);
      }
      if (near.size() < 2) continue;
      const LocalGrid grid(near, period);
      bool seen = grid.valid();
      for (std::size_t k = 0; k < 4 && seen; ++k) {
        const bool right = k == 1 || k == 2, bottom = k >= 2;
        const double x = tag.column * period + right, y = tag.row * period + bottom;
        tag.corners[k] = grid.pixel(x, y);
        seen = is_crossing(image, grid, x, y, right ? -1 : 1, bottom ? -1 : 1, board.spacing);
      }
      if (!seen) continue;
      tags.emplace(id, tag);
      grown = true;
    }
  }
}

}  // namespace

const AprilPrints& aprilgrid_prints() {
  static const AprilPrints all = [] {
    const Family family = make_family();
    AprilPrints list(family->ncodes);
    for (std::uint32_t id = 0; id < family->ncodes; ++id) {
      for (std::uint32_t i = 0; i < family->nbits; ++i) {
        const bool white = ((family->codes[id] >> (family->nbits - 1 - i)) & 1) != 0;
        list[id][family->bit_y[i]][family->bit_x[i]] = white;
      }
    }
    return list;
  }();
  return all;
}

std::vector<AprilTag> find_april_tags(const Board& board, const Image& grey8) {
  // The library searches in tiles of 4 pixels and has no answer for pictures of a few of them.
  if (grey8.width < 32 || grey8.height < 32) return {};
  Tags tags;
  add_tags(board, grey8, 0, tags);
  add_tags(board, lightened(grey8), 1, tags);
  const auto turns = static_cast<std::ptrdiff_t>(quarter_turns(tags));
  for (auto& [id, tag] : tags)
    std::rotate(tag.corners.begin(), tag.corners.begin() + turns, tag.corners.end());
  grow(board, grey8, tags);
  std::vector<AprilTag> found;
  for (const auto& [id, tag] : tags) found.push_back(tag);
  return found;
}

}  // namespace ca2
