#include "core/lidar/covered_returns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace ca2 {
namespace {

/// Half of the square that residuals are averaged over, m: half a finger's width.
constexpr double half_window = 0.012;
/// A mean stands out by this and so many of its standard deviations: boards are bent, and a patch has a
/// thousand returns.
constexpr double least_height = 0.006, least_sigmas = 4;
/// Further before the plane than this a return does not count for more, m.
constexpr float most_height = 0.1F;
/// A ring with fewer returns on the plane does not tell by how much it errs as a whole.
constexpr std::size_t least_in_ring = 12;

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

/// Part of a ring image, row by row: how far before the plane (m) the returns are; NaN: no return, or one
/// behind it.
struct Heights {
  int rows = 0, columns = 0;
  std::vector<float> height;
  std::vector<std::uint32_t> cell;

  std::size_t at(int row, int column) const { return static_cast<std::size_t>(row) * columns + column; }
};

Heights heights_of(const RingImage& image, std::span<const PatchRay> rays, float band) {
  int low = image.rows, high = -1, least = 0, most = 0;
  const int origin = image.column(rays.front().cell);
  const auto place = [&](const PatchRay& ray) {
    return image.wrap(image.column(ray.cell, ray.row) - origin + image.columns / 2) - image.columns / 2;
  };
  for (const PatchRay& ray : rays) {
    low = std::min(low, int{ray.row});
    high = std::max(high, int{ray.row});
    least = std::min(least, place(ray));
    most = std::max(most, place(ray));
  }
  Heights all{high - low + 1, most - least + 1, {}, {}};
  all.height.assign(static_cast<std::size_t>(all.rows) * all.columns, nothing);
  all.cell.assign(all.height.size(), 0);
  for (const PatchRay& ray : rays) {
    const std::size_t i = all.at(ray.row - low, place(ray) - least);
    all.cell[i] = ray.cell;
    if (ray.end != RayEnd::absent && ray.distance >= -band)
      all.height[i] = std::min(ray.distance, most_height);
  }
  return all;
}

/// Lasers have offsets of their own: the median of what is on the plane.
void take_out_rings(Heights& all, float band) {
  std::vector<float> on;
  for (int row = 0; row < all.rows; ++row) {
    on.clear();
    for (int column = 0; column < all.columns; ++column) {
      const float height = all.height[all.at(row, column)];
      if (std::abs(height) <= band) on.push_back(height);
    }
    if (on.size() < least_in_ring) continue;
    const auto middle = on.begin() + static_cast<std::ptrdiff_t>(on.size() / 2);
    std::nth_element(on.begin(), middle, on.end());
    for (int column = 0; column < all.columns; ++column) all.height[all.at(row, column)] -= *middle;
  }
}

/// Sums over any rectangle of the picture, by four of its corners.
class HeightSums {
 public:
  explicit HeightSums(const Heights& all) : stride_(static_cast<std::size_t>(all.columns) + 1) {
    sums_.assign(stride_ * (static_cast<std::size_t>(all.rows) + 1), {});
    for (int row = 0; row < all.rows; ++row) {
      Sum of_row;
      for (int column = 0; column < all.columns; ++column) {
        const float height = all.height[all.at(row, column)];
        if (!std::isnan(height)) of_row = {of_row.height + height, of_row.count + 1};
        const Sum& above = sums_[at(row, column + 1)];
        sums_[at(row + 1, column + 1)] = {above.height + of_row.height, above.count + of_row.count};
      }
    }
  }

  struct Sum {
    double height = 0, count = 0;
  };
  /// From the first row and column on, up to before the last ones.
  Sum over(int first_row, int last_row, int first_column, int last_column) const {
    const Sum &a = sums_[at(last_row, last_column)], &b = sums_[at(first_row, last_column)],
              &c = sums_[at(last_row, first_column)], &d = sums_[at(first_row, first_column)];
    return {a.height - b.height - c.height + d.height, a.count - b.count - c.count + d.count};
  }

 private:
  std::size_t at(int row, int column) const { return static_cast<std::size_t>(row) * stride_ + column; }

  std::size_t stride_;
  std::vector<Sum> sums_;
};

}  // namespace

double covered_reach(double width, double height) {
  return 0.8 * std::hypot(width, height);
}

std::vector<std::uint32_t> find_covered_returns(const Projection& projection, const RingImage& image,
                                                const Plane& plane, const Eigen::Vector3d& centre,
                                                std::span<const PatchRay> rays, double sigma) {
  const double across = sigma * std::abs(plane.normal.dot(centre.normalized()));  // the noise, off the plane
  const auto band = static_cast<float>(std::max(0.02, 4 * across));
  if (rays.empty()) return {};
  Heights all = heights_of(image, rays, band);
  take_out_rings(all, band);
  const double distance = centre.norm();
  const auto reach = [&](double gap) { return static_cast<int>(half_window / (distance * gap) + 0.5); };
  const auto middle_row = std::size_t{rays[rays.size() / 2].row};
  const int rows = std::min(reach(image.row_angle[middle_row]), 4);
  const int columns = std::clamp(reach(image.column_angle), 1, 8);
  std::vector<char> covered(all.height.size(), 0);
  const HeightSums sums(all);
  for (int row = 0; row < all.rows; ++row) {
    const int low = std::max(0, row - rows), high = std::min(all.rows, row + rows + 1);
    for (int column = 0; column < all.columns; ++column) {
      const int least = std::max(0, column - columns), most = std::min(all.columns, column + columns + 1);
      const auto [sum, count] = sums.over(low, high, least, most);
      if (count < 2 || sum < 0.5 * least_height * count) continue;  // as good as all of a board
      if (sum / count < least_height + least_sigmas * across / std::sqrt(count)) continue;
      for (int r = low; r < high; ++r)
        std::fill(&covered[all.at(r, least)], &covered[all.at(r, least)] + (most - least), 1);
    }
  }
  std::vector<std::uint32_t> returns;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    if (covered[i] == 0 || std::isnan(all.height[i])) continue;
    const auto here = projection.cell(all.cell[i]);
    returns.insert(returns.end(), here.begin(), here.end());
  }
  std::sort(returns.begin(), returns.end());
  return returns;
}

}  // namespace ca2
