#include <algorithm>
#include <optional>

#include "core/lidar/scan_grid.h"

namespace ca2 {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kMinColumns = 90, kMaxColumns = 8192;

/// Clockwise from behind, in turns, [0, 1).
float turn(const Eigen::Vector3f& p) {
  return std::clamp((kPi - fast_azimuth(p.x(), p.y())) / (2 * kPi), 0.0f, 0.9999999f);
}

float wrapped(float fraction) {
  return fraction - std::round(fraction);
}

/// Middle of small positive steps, by histogram; steps over 2 degrees are
/// jumps, not steps of the sensor.
class StepHistogram {
 public:
  void add(float step) {
    ++all_;
    if (step > 1e-5f && step < kLargest) ++bins_[static_cast<std::size_t>(step / kLargest * kBins)], ++small_;
  }
  std::optional<float> median() const {
    if (small_ * 2 < all_ || small_ == 0) return std::nullopt;
    int before = 0;
    std::size_t i = 0;
    while (i + 1 < bins_.size() && (before += bins_[i]) * 2 < small_) ++i;
    return (static_cast<float>(i) + 0.5f) / kBins * kLargest;
  }

 private:
  static constexpr float kLargest = 2.0f / 360;  // turns
  static constexpr int kBins = 2000;
  std::vector<int> bins_ = std::vector<int>(kBins + 1, 0);
  int all_ = 0, small_ = 0;
};

/// Azimuths of the returns, in turns; `absent` for what has no place.
constexpr float absent = -1;

std::vector<float> turns_of(const Scan& scan, const std::vector<std::uint16_t>& ring) {
  std::vector<float> turns(scan.size(), absent);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (ring[i] != RingIds::none && is_return(scan.points[i])) turns[i] = turn(scan.points[i]);
  }
  return turns;
}

/// Columns in a turn, from how far the sensor turned between returns of one
/// ring that came one after the other; from the gaps between their sorted
/// azimuths when the file's order says nothing.
int columns_from_azimuths(const RingIds& rings, const std::vector<std::uint16_t>& ring,
                          const std::vector<float>& turns) {
  StepHistogram in_order;
  std::vector<float> last(static_cast<std::size_t>(rings.rings), absent);
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (turns[i] == absent) continue;
    if (last[ring[i]] >= 0) in_order.add(std::abs(wrapped(turns[i] - last[ring[i]])));
    last[ring[i]] = turns[i];
  }
  std::optional<float> step = rings.beams ? in_order.median() : std::nullopt;
  if (!step && rings.beams) {
    std::vector<std::vector<float>> of_ring(static_cast<std::size_t>(rings.rings));
    for (std::size_t i = 0; i < turns.size(); ++i) {
      if (turns[i] != absent) of_ring[ring[i]].push_back(turns[i]);
    }
    StepHistogram sorted;
    for (std::vector<float>& list : of_ring) {
      std::sort(list.begin(), list.end());
      for (std::size_t i = 1; i < list.size(); ++i) sorted.add(list[i] - list[i - 1]);
    }
    step = sorted.median();
  }
  if (!step) {
    // Slices of elevation: as many columns as give a cell one or two returns.
    const auto returns =
        static_cast<float>(std::count_if(turns.begin(), turns.end(), [](float t) { return t != absent; }));
    step = 1.5f * static_cast<float>(rings.rings) / std::max(returns, 1.0f);
  }
  return std::clamp(static_cast<int>(std::lround(1 / *step)), kMinColumns, kMaxColumns);
}

/// The constant part of the rings' azimuths against columns of this size, in
/// columns: the mean of the fractions on the circle.
std::vector<float> ring_phases(const RingIds& rings, const std::vector<std::uint16_t>& ring,
                               const std::vector<float>& turns, float columns) {
  std::vector<Eigen::Vector2f> sum(static_cast<std::size_t>(rings.rings), Eigen::Vector2f::Zero());
  for (std::size_t i = 0; i < turns.size(); i += 5) {
    if (turns[i] == absent) continue;
    const float angle = 2 * kPi * (turns[i] * columns);
    sum[ring[i]] += Eigen::Vector2f(std::cos(angle), std::sin(angle));
  }
  std::vector<float> phase;
  for (const Eigen::Vector2f& s : sum) phase.push_back(std::atan2(s.y(), s.x()) / (2 * kPi));
  return phase;
}

ColumnIds columns_by_azimuth(const Scan& scan, const RingIds& rings) {
  const std::vector<std::uint16_t>& ring = rings.of(scan);
  const std::vector<float> turns = turns_of(scan, ring);
  ColumnIds ids;
  ids.columns = columns_from_azimuths(rings, ring, turns);
  ids.shift.assign(static_cast<std::size_t>(rings.rings), 0);
  ids.found.assign(scan.size(), 0);
  const auto columns = static_cast<float>(ids.columns);
  const std::vector<float> phase = rings.beams
                                       ? ring_phases(rings, ring, turns, columns)
                                       : std::vector<float>(static_cast<std::size_t>(rings.rings), 0.0f);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (turns[i] == absent) continue;
    const int column = static_cast<int>(turns[i] * columns - phase[ring[i]] + 0.5f);
    ids.found[i] = static_cast<std::uint32_t>(std::clamp(column, 0, ids.columns) % ids.columns);
  }
  return ids;
}

/// Directions of the columns, clockwise from behind.
std::vector<Eigen::Vector2f> column_directions(int columns) {
  std::vector<Eigen::Vector2f> list;
  list.reserve(static_cast<std::size_t>(columns));
  const double step = 2 * std::numbers::pi / columns, c = std::cos(step), s = std::sin(step);
  double x = 1, y = 0;
  for (int i = 0; i < columns; ++i) {
    list.emplace_back(static_cast<float>(x), static_cast<float>(y));
    const double turned = x * c - y * s;
    y = x * s + y * c;
    x = turned;
  }
  return list;
}

/// Samples of a ring are enough to tell where its columns look: about this
/// many.
constexpr std::size_t kSamples = 64;

/// A step through a scan that comes by all rings: no sensor has a multiple of
/// these primes.
std::size_t sampling_step(std::size_t returns, int rings) {
  std::size_t best = 1;
  for (const std::size_t prime : {7, 13, 29, 61, 127, 251}) {
    if (prime * kSamples * static_cast<std::size_t>(rings) <= returns) best = prime;
  }
  return best;
}

/// The scan's own columns shifted per ring so that a column is an azimuth;
/// nothing when they are not the same azimuth in all sweeps (firings counted
/// from the start of scans that start anywhere).
std::optional<ColumnIds> columns_as_given(const Scan& scan, const RingIds& rings) {
  if (scan.column.size() != scan.size() || scan.empty() || !rings.beams) return std::nullopt;
  const int columns = scan.columns;
  if (columns < kMinColumns || columns > kMaxColumns) return std::nullopt;
  const std::vector<std::uint16_t>& ring = rings.of(scan);
  const std::vector<Eigen::Vector2f> direction = column_directions(columns);
  const std::size_t step = sampling_step(scan.size(), rings.rings);
  for (const float sign : {1.0f, -1.0f}) {
    // Position minus id on the circle: its mean is the ring's shift, its
    // scatter tells whether ids fit.
    std::vector<Eigen::Vector2f> sum(static_cast<std::size_t>(rings.rings), Eigen::Vector2f::Zero());
    std::vector<int> used(sum.size(), 0);
    for (std::size_t i = 0; i < scan.size(); i += step) {
      const Eigen::Vector3f& p = scan.points[i];
      if (ring[i] == RingIds::none || scan.column[i] >= direction.size() || !is_return(p)) continue;
      const float rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
      if (rho < 1e-3f) continue;
      const float c = direction[scan.column[i]].x(), s = sign * direction[scan.column[i]].y();
      const float x = -p.x() / rho, y = p.y() / rho;  // clockwise from behind
      sum[ring[i]] += Eigen::Vector2f(x * c + y * s, y * c - x * s);
      ++used[ring[i]];
    }
    float together = 0, all = 0;
    for (std::size_t r = 0; r < sum.size(); ++r)
      together += sum[r].norm(), all += static_cast<float>(used[r]);
    // For a small scatter of standard deviation s the mean vector's length is 1
    // - s^2 / 2: s of 0.7 columns.
    const auto count = static_cast<float>(columns);
    const float scatter = 0.7f * 2 * kPi / count;
    if (all == 0 || 1 - together / all > scatter * scatter / 2 + 1e-6f) continue;
    ColumnIds ids;
    ids.columns = columns;
    ids.backwards = sign < 0;
    for (const Eigen::Vector2f& s : sum) {
      const int shift = static_cast<int>(std::lround(std::atan2(s.y(), s.x()) / (2 * kPi) * count));
      ids.shift.push_back(static_cast<std::uint32_t>((shift + columns) % columns));
    }
    return ids;
  }
  return std::nullopt;
}

}  // namespace

ColumnIds find_columns(const Scan& scan, const RingIds& rings) {
  if (std::optional<ColumnIds> ids = columns_as_given(scan, rings)) return *std::move(ids);
  return columns_by_azimuth(scan, rings);
}

}  // namespace ca2
