#include "core/lidar/edge_crossings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/lidar/projection.h"

namespace ca2 {
namespace {

/// Azimuths nearer than this are one look of a sensor whose sweeps fire at the
/// same places, rad.
constexpr double same_place = 1e-4;
/// How far outside the roughly placed rectangle the board may still reach, m.
constexpr double slack = 0.03;

enum class Seen { board, behind, before };

/// What a ring saw at one azimuth.
struct Sample {
  double azimuth = 0;       ///< rad, from the board's centre
  Eigen::Vector3d ray;      ///< unit direction, sensor frame
  Eigen::Vector2d p_plate;  ///< the same in the plate's coordinates
  double behind = 0;        ///< m along the ray
  Seen seen = Seen::behind;
};

using Ring = std::vector<Sample>;  ///< by rising azimuth

class RimFinder {
 public:
  RimFinder(const Scan& scan, const Projection& projection, const RimSearch& board)
      : scan_(scan),
        projection_(projection),
        board_(board),
        rings_(static_cast<std::size_t>(projection.rings)) {
    const Eigen::Vector3d& center = board.T_lidar_board.t;
    distance_ = center.head<2>().norm();
    azimuth_ = std::atan2(center.y(), center.x());
    band_ = std::max(0.02, 4 * board.noise);
    // Beyond the rim as far as its neighbours lie: some columns, and a ring.
    const double facing = std::clamp(-board.plane.normal.dot(center.normalized()), 0.2, 1.0);
    const double gap = center.norm() * std::max(5 * projection.column_angle(), 1.5 * ring_gap()) / facing;
    reach_ = slack + std::min(gap, 0.22);
    radius_ = 0.5 * std::hypot(board.width, board.height) + reach_;
    axis_ = center.normalized().cast<float>();
    const double sine = std::min(1.0, radius_ / center.norm());
    cosine_squared_ = static_cast<float>(1 - sine * sine) - 1e-4f;
    R_board_lidar_ = board.T_lidar_board.R.transpose();
  }

  std::vector<EdgeCrossing> find() {
    if (!projection_.beams || distance_ < 1.1 * radius_) return {};
    for (std::size_t r = 0; r < rings_.size(); ++r) {
      if (reaches(r)) rings_[r] = gather(static_cast<int>(r));
    }
    measure_step();
    if (!(step_ > 0)) return {};
    for (std::size_t r = 0; r < rings_.size(); ++r) add_ends(static_cast<std::uint16_t>(r));
    add_outermost_rings();
    return std::move(crossings_);
  }

 private:
  bool on_plate(const Sample& sample) const {
    return sample.seen == Seen::board && std::abs(sample.p_plate.x()) <= 0.5 * board_.width + slack &&
           std::abs(sample.p_plate.y()) <= 0.5 * board_.height + slack;
  }

  /// rad between neighbouring rings, the widest gap of those that reach the
  /// board's height.
  double ring_gap() const {
    double widest = 0, last = std::numeric_limits<double>::quiet_NaN();
    const double middle = std::atan2(board_.T_lidar_board.t.z(), distance_);
    for (const int ring : projection_.by_elevation) {
      const double elevation = std::atan(projection_.slope[static_cast<std::size_t>(ring)]);
      if (std::abs(elevation - middle) < 0.5 && elevation - last > widest) widest = elevation - last;
      last = elevation;
    }
    return widest;
  }

  /// May this ring pass the board? Its steepest cone still meets the sphere
  /// round it.
  bool reaches(std::size_t ring) const {
    const double slope = projection_.slope[ring], height = projection_.height[ring];
    return std::abs(height + slope * distance_ - board_.T_lidar_board.t.z()) <
           radius_ * (1 + std::abs(slope));  // false for an empty ring
  }

  std::optional<Sample> look(const Eigen::Vector3f& point, double height) const {
    const float along = axis_.dot(point);
    if (!(along > 0 && along * along > cosine_squared_ * point.squaredNorm())) return std::nullopt;
    const Eigen::Vector3d origin(0, 0, height);
    const Eigen::Vector3d way = point.cast<double>() - origin;
    const double range = way.norm();
    const double toward = -board_.plane.normal.dot(way) / range;
    if (!(toward > 0.02)) return std::nullopt;
    Sample sample;
    const double expected = board_.plane.distance(origin) / toward;
    sample.ray = way / range;
    const Eigen::Vector3d p_board =
        R_board_lidar_ * (origin + expected * sample.ray - board_.T_lidar_board.t);
    if (std::abs(p_board.x()) > 0.5 * board_.width + reach_ ||
        std::abs(p_board.y()) > 0.5 * board_.height + reach_) {
      return std::nullopt;
    }
    sample.p_plate = p_board.head<2>();
    // From the board's centre, so that single precision does.
    sample.azimuth = std::atan2(axis_.x() * point.y() - axis_.y() * point.x(),
                                axis_.x() * point.x() + axis_.y() * point.y());
    sample.behind = range - expected;
    sample.seen = sample.behind > band_ ? Seen::behind : sample.behind < -band_ ? Seen::before : Seen::board;
    return sample;
  }

  /// The samples of a ring round the board. Several looks at one place are one:
  /// the board where most of them ended on it.
  Ring gather(int ring) {
    Ring& all = gathered_;
    all.clear();
    const double columns_per_rad = 1 / projection_.column_angle();
    const double height = projection_.height[static_cast<std::size_t>(ring)];
    const int half = std::min(static_cast<int>(std::asin(radius_ / distance_) * columns_per_rad) + 2,
                              projection_.columns / 2 - 1);
    const int middle = static_cast<int>((std::numbers::pi - azimuth_) * columns_per_rad);
    // Columns rise clockwise.
    int column = (middle + half) % projection_.columns;
    for (int k = half; k >= -half; --k, column = column > 0 ? column - 1 : projection_.columns - 1) {
      const std::size_t cell = projection_.index(ring, column);
      for (const std::uint32_t i : projection_.cell(cell)) {
        auto sample = look(projection_.point_of(i, cell, scan_), height);
        if (!sample) continue;
        if (std::binary_search(board_.covered.begin(), board_.covered.end(), i)) sample->seen = Seen::before;
        all.push_back(*sample);
      }
    }
    const auto before = [](const Sample& a, const Sample& b) { return a.azimuth < b.azimuth; };
    if (!std::is_sorted(all.begin(), all.end(), before)) std::stable_sort(all.begin(), all.end(), before);
    Ring merged;
    merged.reserve(all.size());
    for (std::size_t i = 0; i < all.size();) {
      std::size_t end = i + 1;
      while (end < all.size() && all[end].azimuth - all[i].azimuth < same_place) ++end;
      if (end == i + 1) {
        merged.push_back(all[i++]);
        continue;
      }
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(i);
      const auto last = all.begin() + static_cast<std::ptrdiff_t>(end);
      const auto is = [](Seen seen) { return [seen](const Sample& s) { return s.seen == seen; }; };
      Seen seen = std::any_of(first, last, is(Seen::before)) ? Seen::before : Seen::behind;
      if (2 * std::count_if(first, last, is(Seen::board)) >= last - first) seen = Seen::board;
      merged.push_back(*std::find_if(first, last, is(seen)));
      i = end;
    }
    return merged;
  }

  /// The usual step from one ray of a ring to the next, and whether all steps
  /// are that long: not where sweeps that fire at other places are gathered.
  void measure_step() {
    std::vector<double> steps;
    for (const Ring& ring : rings_) {
      for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
        if (on_plate(ring[i]) && on_plate(ring[i + 1]))
          steps.push_back(ring[i + 1].azimuth - ring[i].azimuth);
      }
    }
    if (steps.size() < 8) return;
    const auto in_order = [&](std::size_t place) {
      const auto at = steps.begin() + static_cast<std::ptrdiff_t>(place);
      std::nth_element(steps.begin(), at, steps.end());
      return *at;
    };
    step_ = in_order(steps.size() / 2);
    regular_ = in_order(steps.size() * 85 / 100) - in_order(steps.size() * 15 / 100) < 0.3 * step_;
  }

  /// The outermost sample on the plate towards one side (`way`: -1 or 1) that
  /// is no stray; -1: none.
  static constexpr int none = -1;
  int outermost(const Ring& ring, int way) const {
    const int count = static_cast<int>(ring.size());
    for (int i = way > 0 ? count - 1 : 0; i >= 0 && i < count; i -= way) {
      if (!on_plate(ring[static_cast<std::size_t>(i)])) continue;
      int beside = 0;
      for (int k = 1; k <= 3; ++k) {
        const int inner = i - way * k;
        beside += inner >= 0 && inner < count && on_plate(ring[static_cast<std::size_t>(inner)]) ? 1 : 0;
      }
      if (beside >= 2) return i;
    }
    return none;
  }

  void add_ends(std::uint16_t ring) {
    for (const int way : {-1, 1}) {
      const int last = outermost(rings_[ring], way);
      if (last != none) add_end(ring, last, way);
    }
  }

  void add_end(std::uint16_t r, int last, int way) {
    const Ring& ring = rings_[r];
    const Sample& inside = ring[static_cast<std::size_t>(last)];
    const auto at = [&](int i) -> const Sample* {
      return i >= 0 && i < static_cast<int>(ring.size()) ? &ring[static_cast<std::size_t>(i)] : nullptr;
    };
    const Sample* next = at(last + way);
    double gap = next ? way * (next->azimuth - inside.azimuth) : std::numeric_limits<double>::infinity();
    if (gap > 3 * step_) next = nullptr;
    float jump = std::numeric_limits<float>::infinity();
    if (next) {
      // More of the same surface: nothing ends here.
      if (next->seen == Seen::board) return;
      // A mixture of what covers the rim and what is behind it may look like
      // either.
      const Sample* after = at(last + 2 * way);
      const bool covered = next->seen == Seen::before || (after && after->seen == Seen::before);
      jump = static_cast<float>(covered ? std::min(next->behind, -band_) : next->behind);
    }
    // Regular rays are where the step says: the next return may lie far behind, where a ray that does not
    // start in the origin is seen under another azimuth (by less than half a step). What rays in between met
    // is not known: theirs were lost, at the rim more often than elsewhere.
    if (!next) gap = step_;
    if (regular_) gap = step_ * std::max(1.0, std::round(gap / step_ - 0.2));
    const Eigen::AngleAxisd turn(way * gap, Eigen::Vector3d::UnitZ());
    const float height = projection_.height[r];
    crossings_.push_back(
        {inside.ray.cast<float>(), (turn * inside.ray).cast<float>(), jump, r, false, height, height});
  }

  /// Upwards and downwards the board ends between two rings.
  void add_outermost_rings() {
    std::vector<int> order;  // of elevation, those that were looked at
    for (const int ring : projection_.by_elevation) order.push_back(ring);
    const auto sees = [&](int ring) { return outermost(rings_[static_cast<std::size_t>(ring)], 1) != none; };
    const int count = static_cast<int>(order.size());
    int low = 0, high = count - 1;
    while (low < count && !sees(order[static_cast<std::size_t>(low)])) ++low;
    while (high > low && !sees(order[static_cast<std::size_t>(high)])) --high;
    if (low >= count) return;
    if (low > 0) add_between(order[static_cast<std::size_t>(low)], order[static_cast<std::size_t>(low - 1)]);
    if (high + 1 < count)
      add_between(order[static_cast<std::size_t>(high)], order[static_cast<std::size_t>(high + 1)]);
  }

  void add_between(int last, int beyond) {
    const Ring& ring = rings_[static_cast<std::size_t>(last)];
    const Ring& other = rings_[static_cast<std::size_t>(beyond)];
    for (const Sample& inside : ring) {
      if (!on_plate(inside)) continue;
      const auto outside = where(beyond, inside.azimuth + azimuth_);
      if (!outside) continue;
      const auto next = std::min_element(other.begin(), other.end(), [&](const Sample& a, const Sample& b) {
        return std::abs(a.azimuth - inside.azimuth) < std::abs(b.azimuth - inside.azimuth);
      });
      float jump = std::numeric_limits<float>::infinity();
      if (next != other.end() && std::abs(next->azimuth - inside.azimuth) < step_) {
        if (next->seen == Seen::board) continue;
        jump = static_cast<float>(next->seen == Seen::before ? std::min(next->behind, -band_) : next->behind);
      }
      crossings_.push_back({inside.ray.cast<float>(), outside->cast<float>(), jump,
                            static_cast<std::uint16_t>(last), true,
                            projection_.height[static_cast<std::size_t>(last)],
                            projection_.height[static_cast<std::size_t>(beyond)]});
    }
  }

  /// Direction of a ring's ray of this azimuth; nothing where it does not meet the plane.
  std::optional<Eigen::Vector3d> where(int ring, double azimuth) const {
    const double slope = projection_.slope[static_cast<std::size_t>(ring)];
    const Eigen::Vector3d along(std::cos(azimuth), std::sin(azimuth), slope);
    if (!(-board_.plane.normal.dot(along) > 0.02)) return std::nullopt;
    return along.normalized();
  }

  const Scan& scan_;
  const Projection& projection_;
  const RimSearch& board_;
  std::vector<Ring> rings_;
  Ring gathered_;  ///< what a ring is made from
  double distance_ = 0,
         azimuth_ = 0;        ///< of the board's centre: horizontal, m; rad
  double reach_ = 0;          ///< m, beyond the rim
  double radius_ = 0;         ///< m, of all that is looked at
  Eigen::Vector3f axis_;      ///< towards the board's centre, unit
  float cosine_squared_ = 0;  ///< of the cone round it that holds the board
  Eigen::Matrix3d R_board_lidar_;
  double band_ = 0;  ///< m
  double step_ = 0;  ///< rad
  bool regular_ = false;
  std::vector<EdgeCrossing> crossings_;
};

}  // namespace

std::vector<EdgeCrossing> find_edge_crossings(const Scan& scan, const Projection& projection,
                                              const RimSearch& board) {
  return RimFinder(scan, projection, board).find();
}

}  // namespace ca2
