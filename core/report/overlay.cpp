#include "core/report/overlay.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <unordered_map>
#include <vector>

#include "core/report/visibility.h"

namespace ca2 {
namespace {

double percentile(std::vector<double>& values, double share) {
  const auto index = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

/// Three channels, 8 bits, all alike.
Image grey_canvas(const Image& image) {
  const Image grey = to_grey8(image);
  Image canvas{grey.width, grey.height, 3, 8, {}};
  canvas.bytes.resize(3 * grey.bytes.size());
  for (std::size_t i = 0; i < grey.bytes.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) canvas.bytes[3 * i + k] = grey.bytes[i];
  }
  return canvas;
}

cv::Mat view_of(Image& image) {
  return {image.height, image.width, CV_8UC3, image.bytes.data()};
}

/// Of an arrow's end, as far off as it may be.
cv::Point rounded(const Eigen::Vector2d& p) {
  const Eigen::Vector2d near = p.cwiseMax(-1e6).cwiseMin(1e6);
  return {static_cast<int>(std::lround(near.x())), static_cast<int>(std::lround(near.y()))};
}

cv::Scalar scalar(Colour colour) {
  return {double(colour.r), double(colour.g), double(colour.b)};
}

/// Angle between neighbouring points, if they lay evenly over the part of the view that they cover.
double mean_spacing(const Camera& camera, std::size_t points) {
  const double solid_angle = std::min(4 * M_PI, static_cast<double>(camera.width) * camera.height /
                                                    (camera.parameters(0) * camera.parameters(1)));
  return std::sqrt(solid_angle / static_cast<double>(std::max<std::size_t>(points, 1)));
}

}  // namespace

Colour range_colour(double share) {
  // Hue from red over yellow, green and cyan to blue, at full saturation.
  const double hue = 4 * std::clamp(share, 0.0, 1.0);
  const auto channel = [&](double centre) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(2 - std::abs(hue - centre), 0.0, 1.0)));
  };
  return {channel(0), channel(2), channel(4)};
}

Colour signed_colour(double share) {
  const double s = std::clamp(share, -1.0, 1.0);
  const auto fade = [&](double full) {
    return static_cast<std::uint8_t>(std::lround(255 + (full - 255) * std::abs(s)));
  };
  return s < 0 ? Colour{fade(33), fade(102), 255} : Colour{fade(224), fade(32), fade(32)};
}

std::vector<SeenPoint> seen_points(const Camera& camera, const Scan& scan, const Pose& T_camera_lidar) {
  std::vector<SeenPoint> inside;
  std::unordered_map<std::int64_t, std::size_t> nearest;  // of a cell of 2 x 2 pixels, in `inside`
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!scan.points[i].allFinite() || scan.points[i].squaredNorm() < 1e-4f) continue;
    const Eigen::Vector3d p = T_camera_lidar * scan.points[i].cast<double>();
    const std::optional<Eigen::Vector2d> pixel = camera.project(p);
    if (!pixel || !camera.contains(*pixel)) continue;
    const std::int64_t cell =
        static_cast<std::int64_t>(pixel->y() / 2) * camera.width + static_cast<std::int64_t>(pixel->x() / 2);
    const SeenPoint seen{static_cast<std::uint32_t>(i), p, *pixel};
    const auto [at, fresh] = nearest.emplace(cell, inside.size());
    if (fresh) {
      inside.push_back(seen);
    } else if (p.squaredNorm() < inside[at->second].point.squaredNorm()) {
      inside[at->second] = seen;
    }
  }
  std::vector<Eigen::Vector3d> points;
  for (const SeenPoint& seen : inside) points.push_back(seen.point);
  std::vector<SeenPoint> visible;
  for (const std::uint32_t i : visible_from_origin(points, mean_spacing(camera, points.size()))) {
    visible.push_back(inside[i]);
  }
  return visible;
}

Overlay draw_overlay(const Image& image, const std::vector<SeenPoint>& points, int width) {
  // Dots are drawn at the final size: made smaller with the picture they would fade into it.
  Overlay overlay{reduced(grey_canvas(image), width), 0, 0};
  if (points.empty()) return overlay;
  std::vector<const SeenPoint*> order;
  std::vector<double> ranges;
  for (const SeenPoint& point : points) {
    order.push_back(&point);
    ranges.push_back(point.point.norm());
  }
  overlay.near = percentile(ranges, 0.02);
  overlay.far = std::max(percentile(ranges, 0.98), overlay.near + 1e-3);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
    return a->point.squaredNorm() > b->point.squaredNorm();
  });
  cv::Mat canvas = view_of(overlay.image);
  const int radius = std::max(1, overlay.image.width / 640);
  const double zoom = static_cast<double>(overlay.image.width) / image.width;
  const auto at = [&](const Eigen::Vector2d& p) {
    return rounded((p + Eigen::Vector2d(0.5, 0.5)) * zoom - Eigen::Vector2d(0.5, 0.5));
  };
  for (const SeenPoint* point : order) {
    const double share = (point->point.norm() - overlay.near) / (overlay.far - overlay.near);
    cv::circle(canvas, at(point->pixel), radius, scalar(range_colour(share)), cv::FILLED);
  }
  return overlay;
}

Image reduced(const Image& image, int width) {
  if (image.width <= width) return image;
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(image.height) * width / image.width)));
  Image result{
      width, height, 3, 8,
      std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  Image source = image;
  cv::Mat small = view_of(result);
  cv::resize(view_of(source), small, {width, height}, 0, 0, cv::INTER_AREA);
  return result;
}

Image draw_residuals(const Image& image, const Camera& camera, const Pose& T_camera_lidar,
                     const std::vector<CornerError>& corners, const std::vector<BoardPointError>& points,
                     double scale, double magnified, int width) {
  std::vector<cv::Point2f> places;
  for (const CornerError& corner : corners)
    places.emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
  std::vector<std::pair<Eigen::Vector2d, double>> dots;
  for (const BoardPointError& point : points) {
    const auto pixel = camera.project(T_camera_lidar * point.point);
    if (!pixel || !camera.contains(*pixel)) continue;
    dots.emplace_back(*pixel, point.error);
    places.emplace_back(static_cast<float>(pixel->x()), static_cast<float>(pixel->y()));
  }
  Image canvas = grey_canvas(image);
  if (places.empty()) return reduced(canvas, width);
  cv::Rect box = cv::boundingRect(places);
  const int margin = std::max(box.width, box.height) / 6 + 4;
  box = cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
        cv::Rect(0, 0, canvas.width, canvas.height);
  const double zoom = static_cast<double>(width) / box.width;
  Image result{width, std::max(1, static_cast<int>(box.height * zoom)), 3, 8, {}};
  result.bytes.resize(3 * static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height));
  cv::Mat out = view_of(result);
  cv::resize(view_of(canvas)(box), out, out.size(), 0, 0, zoom < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  const auto at = [&](const Eigen::Vector2d& p) {
    return rounded((p - Eigen::Vector2d(box.x, box.y)) * zoom);
  };
  for (const auto& [pixel, error] : dots)
    cv::circle(out, at(pixel), 2, scalar(signed_colour(error / scale)), cv::FILLED);
  for (const CornerError& corner : corners) {
    const cv::Point from = at(corner.pixel), to = from + rounded(corner.error * magnified);
    cv::line(out, from, to, {255, 200, 0}, 1, cv::LINE_AA);
    cv::circle(out, from, 2, {255, 200, 0}, 1, cv::LINE_AA);
  }
  return result;
}

}  // namespace ca2
