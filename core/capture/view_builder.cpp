#include "core/capture/view_builder.h"

#include <algorithm>
#include <cstring>

#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

template <class Sample>
void add_samples(const std::vector<std::uint8_t>& bytes, std::vector<std::uint32_t>& sum) {
  for (std::size_t i = 0; i < sum.size(); ++i) {
    Sample sample;
    std::memcpy(&sample, bytes.data() + i * sizeof sample, sizeof sample);
    sum[i] += sample;
  }
}

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

template <class Value, class Text>
std::string map_text(const char* key, const std::map<std::string, Value>& map, Text text) {
  if (map.empty()) return {};
  std::string line = std::string(key) + ": {";
  for (const auto& [name, value] : map) {
    if (line.back() != '{') line += ", ";
    line += name + ": " + text(value);
  }
  return line + "}\n";
}

}  // namespace

Image mean_image(const std::vector<const CameraObservation*>& pictures) {
  const Image& first = *pictures.front()->image;
  if (pictures.size() == 1) return first;
  std::vector<std::uint32_t> sum(first.bytes.size() / static_cast<std::size_t>(first.bits / 8), 0);
  std::uint32_t count = 0;
  for (const CameraObservation* picture : pictures) {
    const Image& image = *picture->image;
    if (image.bits != first.bits || image.bytes.size() != first.bytes.size()) continue;
    if (first.bits == 8)
      add_samples<std::uint8_t>(image.bytes, sum);
    else
      add_samples<std::uint16_t>(image.bytes, sum);
    ++count;
  }
  Image mean{first.width, first.height, first.channels, 16, {}};
  mean.bytes.resize(2 * sum.size());
  // 255 becomes 65535.
  const std::uint32_t scale = first.bits == 8 ? 257 : 1;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const auto value = static_cast<std::uint16_t>((sum[i] * scale + count / 2) / count);
    std::memcpy(mean.bytes.data() + 2 * i, &value, 2);
  }
  return mean;
}

Scan gathered_scan(const std::vector<const LidarObservation*>& scans) {
  Scan all;
  for (const LidarObservation* observation : scans) {
    const Scan& scan = *observation->scan;
    append(all.points, scan.points);
    append(all.intensity, scan.intensity);
    append(all.range, scan.range);
    append(all.ring, scan.ring);
    append(all.column, scan.column);
    append(all.time, scan.time);
    all.rings = std::max(all.rings, scan.rings);
    all.columns = std::max(all.columns, scan.columns);
  }
  const std::size_t size = all.points.size();
  if (all.intensity.size() != size) all.intensity.clear();
  if (all.range.size() != size) all.range.clear();
  if (all.ring.size() != size) all.ring.clear();
  if (all.column.size() != size) all.column.clear();
  if (all.time.size() != size) all.time.clear();
  return all;
}

std::string details_text(const ViewDetails& details) {
  const auto number = [](std::size_t value) { return std::to_string(value); };
  std::string text = "version: 1\n";
  text += std::string("trigger: ") + (details.automatic ? "automatic" : "manual") + "\n";
  text += map_text("frames", details.pictures, number);
  text += map_text("scans", details.scans, number);
  text += map_text("corners", details.corners, number);
  text += map_text("gates", details.gates, [](const std::string& reason) {
    return reason.empty() ? std::string("passed") : yaml_string(reason);
  });
  text += map_text("picks", details.picks, [](const Pick& pick) {
    return "{row: " + std::to_string(pick.row) + ", column: " + std::to_string(pick.column) +
           ", radius: " + exact(pick.radius) + "}";
  });
  text += map_text("stamps", details.stamps, [](const std::vector<std::int64_t>& stamps) {
    std::string list = "[";
    for (const std::int64_t stamp : stamps) list += (list.size() > 1 ? ", " : "") + std::to_string(stamp);
    return list + "]";
  });
  return text;
}

}  // namespace ca2
