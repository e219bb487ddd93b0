#include <algorithm>
#include <cmath>

#include "core/board/detect/lattice.h"

namespace ca2 {
namespace {

// Directions come from a few pixels, and lines bend in a fisheye.
constexpr double least_cosine = 0.96;
// Saddles looked at round each: bounds the time on texture.
constexpr int most_visits = 100;
constexpr int most_rings = 14;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The slot of a saddle that leads along an offset, or -1. Most offsets lead along none: those cost four
/// multiplications each.
inline int slot_along(const Saddle& saddle, const Eigen::Vector2d& offset) {
  const double along0 = saddle.e0.dot(offset);
  const double along1 = saddle.e1.dot(offset);
  const double best = std::max(std::abs(along0), std::abs(along1));
  if (best * best < least_cosine * least_cosine * offset.squaredNorm()) return -1;
  if (std::abs(along0) >= std::abs(along1)) return along0 > 0 ? 0 : 2;
  return along1 > 0 ? 1 : 3;
}

/// Saddles in square cells of the picture, for visits from near to far.
class Buckets {
 public:
  explicit Buckets(const std::vector<Saddle>& saddles, int width, int height)
      : size_(std::max(24.0, width / 50.0)),
        columns_(static_cast<int>(width / size_) + 1),
        rows_(static_cast<int>(height / size_) + 1),
        cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    for (std::size_t i = 0; i < saddles.size(); ++i) {
      cells_[index(column(saddles[i].pixel.x()), row(saddles[i].pixel.y()))].push_back(static_cast<int>(i));
    }
  }

  double size() const { return size_; }

  template <class Visit>
  void ring(const Eigen::Vector2d& pixel, int radius, Visit visit) const {
    const int x = column(pixel.x());
    const int y = row(pixel.y());
    for (int j = std::max(0, y - radius); j <= std::min(rows_ - 1, y + radius); ++j) {
      const bool whole_row = j == y - radius || j == y + radius;
      const int step = whole_row || radius == 0 ? 1 : 2 * radius;
      for (int i = x - radius; i <= x + radius; i += step) {
        if (i < 0 || i >= columns_) continue;
        for (const int k : cells_[index(i, j)]) visit(k);
      }
    }
  }

 private:
  int column(double x) const { return std::clamp(static_cast<int>(x / size_), 0, columns_ - 1); }
  int row(double y) const { return std::clamp(static_cast<int>(y / size_), 0, rows_ - 1); }
  std::size_t index(int i, int j) const { return static_cast<std::size_t>(j) * columns_ + i; }

  double size_;
  int columns_;
  int rows_;
  std::vector<std::vector<int>> cells_;
};

struct Neighbour {
  double distance;
  int index;
  int slot;
};

/// The nearest saddle in each slot's direction that an edge joins.
std::array<int, 4> nearest_neighbours(const std::vector<SaddleLevel>& levels,
                                      const std::vector<Saddle>& saddles, const Buckets& buckets, int self,
                                      const Squares& squares) {
  const Saddle& a = saddles[static_cast<std::size_t>(self)];
  std::array<int, 4> nearest{-1, -1, -1, -1};
  int visits = 0;
  std::vector<Neighbour> seen;
  for (int radius = 0; radius <= most_rings && visits < most_visits; ++radius) {
    buckets.ring(a.pixel, radius, [&](int k) {
      ++visits;
      if (k == self) return;
      const Saddle& b = saddles[static_cast<std::size_t>(k)];
      const Eigen::Vector2d offset = b.pixel - a.pixel;
      const int slot = slot_along(a, offset);
      if (slot < 0 || nearest[static_cast<std::size_t>(slot)] >= 0) return;
      const double distance = offset.norm();
      if (distance >= 2.5) seen.push_back({distance, k, slot});
    });
    // What is nearer than the next ring's nearest possible is settled.
    std::sort(seen.begin(), seen.end(), [](const Neighbour& p, const Neighbour& q) {
      return std::tie(p.distance, p.index) < std::tie(q.distance, q.index);
    });
    std::size_t done = 0;
    for (; done < seen.size() && seen[done].distance <= radius * buckets.size(); ++done) {
      int& best = nearest[static_cast<std::size_t>(seen[done].slot)];
      const Saddle& b = saddles[static_cast<std::size_t>(seen[done].index)];
      if (best < 0 && edge_between(levels, a, seen[done].slot, b, squares)) best = seen[done].index;
    }
    seen.erase(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(done));
    if (*std::min_element(nearest.begin(), nearest.end()) >= 0) break;
  }
  for (const Neighbour& rest : seen) {
    int& best = nearest[static_cast<std::size_t>(rest.slot)];
    const Saddle& b = saddles[static_cast<std::size_t>(rest.index)];
    if (best < 0 && edge_between(levels, a, rest.slot, b, squares)) best = rest.index;
  }
  return nearest;
}

using Links = std::vector<std::array<int, 4>>;

/// The slot by which `from` is linked to `to`, or -1.
int slot_to(const Links& links, int from, int to) {
  const auto& slots = links[static_cast<std::size_t>(from)];
  const auto it = std::find(slots.begin(), slots.end(), to);
  return it == slots.end() ? -1 : static_cast<int>(it - slots.begin());
}

/// Is the link of `a` by `slot` a side of a closed square of four links, on either side of it? All links of a
/// board are; those from a board's rim to what lies behind it hardly ever.
bool in_square(const std::vector<Saddle>& saddles, const Links& links, int a, int slot) {
  const auto link = [&](int from, int by) {
    return links[static_cast<std::size_t>(from)][static_cast<std::size_t>(by)];
  };
  const auto distance = [&](int p, int q) {
    return (saddles[static_cast<std::size_t>(p)].pixel - saddles[static_cast<std::size_t>(q)].pixel).norm();
  };
  const int b = link(a, slot);
  const int back = slot_to(links, b, a);
  for (const int half_turn : {0, 2}) {  // the bright side, then the dark one
    const int d = link(a, (bright_slot(slot) + half_turn) % 4);
    const int c = link(b, (bright_slot(back) + half_turn) % 4);
    if (c < 0 || d < 0 || slot_to(links, d, c) < 0) continue;
    const double ratio = distance(a, b) / distance(d, c);
    if (ratio > 0.5 && ratio < 2) return true;
  }
  return false;
}

/// The links for which keep(saddle, slot) holds, judged on all of them.
template <class Keep>
Links filtered(const Links& links, Keep keep) {
  Links kept = links;
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (int slot = 0; slot < 4; ++slot) {
      int& other = kept[i][static_cast<std::size_t>(slot)];
      if (other >= 0 && !keep(static_cast<int>(i), slot)) other = -1;
    }
  }
  return kept;
}

}  // namespace

bool edge_between(const std::vector<SaddleLevel>& levels, const Saddle& a, int slot, const Saddle& b,
                  const Squares& squares) {
  const Eigen::Vector2d offset = b.pixel - a.pixel;
  const double length = offset.norm();
  const int back = slot_along(b, -offset);
  if (back < 0) return false;
  const Eigen::Vector2d bright_a = slot_direction(a, bright_slot(slot));
  const Eigen::Vector2d bright_b = slot_direction(b, bright_slot(back));
  // Both see the bright square on the same side.
  if (cross(offset, bright_a) * cross(offset, bright_b) <= 0) return false;
  const SaddleLevel& level = levels[static_cast<std::size_t>(std::max(a.level, b.level))];
  // Far enough from the edge to be beyond its blur, near enough to be within a foreshortened square.
  const double reach = std::max(0.5 * squares.plain * length, 0.7 * level.scale);
  double least = 1e9;
  double most = -1e9;
  for (const double t : {0.3, 0.5, 0.7}) {
    const Eigen::Vector2d middle = a.pixel + t * offset;
    const Eigen::Vector2d side = ((1 - t) * bright_a + t * bright_b) * reach;
    const double difference = level.grey(middle + side) - level.grey(middle - side);
    least = std::min(least, difference);
    most = std::max(most, difference);
  }
  return least > 5 && least > 0.4 * most;
}

std::vector<std::array<int, 4>> link_neighbours(const std::vector<SaddleLevel>& levels,
                                                const std::vector<Saddle>& saddles, const Squares& squares) {
  const Buckets buckets(saddles, levels[0].width, levels[0].height);
  std::vector<std::array<int, 4>> links;
  links.reserve(saddles.size());
  for (std::size_t i = 0; i < saddles.size(); ++i) {
    links.push_back(nearest_neighbours(levels, saddles, buckets, static_cast<int>(i), squares));
  }
  links = filtered(links, [&](int a, int slot) {
    return slot_to(links, links[static_cast<std::size_t>(a)][static_cast<std::size_t>(slot)], a) >= 0;
  });
  return filtered(links, [&](int a, int slot) { return in_square(saddles, links, a, slot); });
}

}  // namespace ca2
