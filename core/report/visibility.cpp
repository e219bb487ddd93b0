#include "core/report/visibility.h"

extern "C" {
#include <libqhull_r/libqhull_r.h>
}

#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>

namespace ca2 {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// Indices of the points on the convex hull; all of them where there is none (too few, or in a plane).
std::vector<std::uint32_t> hull(std::vector<double>& coordinates) {
  const int count = static_cast<int>(coordinates.size() / 3);
  // The library must not print; without an output file it does not check and sum up what it would print
  // either. Its reentrant half has all its state in `qh`.
  const std::unique_ptr<std::FILE, FileCloser> nowhere(std::fopen("/dev/null", "w"));
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, nowhere.get());
  char options[] = "qhull Qs";
  std::vector<std::uint32_t> vertices;
  const int failed =
      count < 5 || qh_new_qhull(qh, 3, count, coordinates.data(), False, options, nullptr, nowhere.get());
  if (failed == 0) {
    for (const vertexT* vertex = qh->vertex_list; vertex && vertex->next; vertex = vertex->next) {
      vertices.push_back(static_cast<std::uint32_t>(qh_pointid(qh, vertex->point)));
    }
  }
  if (count >= 5) {
    qh_freeqhull(qh, !qh_ALL);
    int blocks = 0, bytes = 0;
    qh_memfreeshort(qh, &blocks, &bytes);
  }
  if (failed != 0) {
    vertices.resize(static_cast<std::size_t>(count));
    std::iota(vertices.begin(), vertices.end(), 0u);
  }
  return vertices;
}

}  // namespace

std::vector<std::uint32_t> visible_from_origin(const std::vector<Eigen::Vector3d>& points, double spacing,
                                               double depth) {
  double farthest = 0;
  for (const Eigen::Vector3d& p : points) farthest = std::max(farthest, p.norm());
  // Between two flipped neighbours the sphere of radius R bulges by R spacing^2 / 8: a point that is hidden
  // lies as deep behind them.
  const double radius = std::max(2 * farthest, 8 * depth / (spacing * spacing));
  std::vector<double> flipped;
  std::vector<std::uint32_t> index;
  flipped.reserve(3 * points.size() + 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double range = points[i].norm();
    if (!(range > 0)) continue;
    const Eigen::Vector3d f = points[i] * ((2 * radius - range) / range);
    flipped.insert(flipped.end(), f.data(), f.data() + 3);
    index.push_back(static_cast<std::uint32_t>(i));
  }
  flipped.insert(flipped.end(), 3, 0.0);  // the viewer
  std::vector<std::uint32_t> seen;
  for (const std::uint32_t vertex : hull(flipped)) {
    if (vertex < index.size()) seen.push_back(index[vertex]);
  }
  std::sort(seen.begin(), seen.end());
  return seen;
}

}  // namespace ca2
