#include "core/capture/view_builder.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

// Sums of so many samples at a time stay in the processor's nearest cache.
constexpr std::size_t block = 4096;

/// The means of samples, 16 bits each.
class Means {
 public:
  Means(int bits, std::uint32_t count) : bits_(bits), count_(count) {
    if (bits_ != 8) return;
    // A division per sample is what would cost most; there are few different sums.
    for (std::uint32_t sum = 0; sum <= 255 * count_; ++sum) table_.push_back(mean(sum * 257));  // 255: 65535
  }

  /// `count` samples at `first` of every picture.
  void put(const std::vector<const Image*>& pictures, std::size_t first, std::size_t count,
           std::uint8_t* to) const {
    std::uint16_t means[block];
    if (bits_ == 8 && count_ <= most_in_16_bits) {
      const auto sums = sum<std::uint8_t, std::uint16_t>(pictures, first, count);
      for (std::size_t i = 0; i < count; ++i) means[i] = table_[sums[i]];
    } else if (bits_ == 8) {
      const auto sums = sum<std::uint8_t, std::uint32_t>(pictures, first, count);
      for (std::size_t i = 0; i < count; ++i) means[i] = table_[sums[i]];
    } else {
      const auto sums = sum<std::uint16_t, std::uint32_t>(pictures, first, count);
      for (std::size_t i = 0; i < count; ++i) means[i] = mean(sums[i]);
    }
    std::memcpy(to, means, 2 * count);
  }

 private:
  static constexpr std::uint32_t most_in_16_bits = 257;  // pictures

  template <class Sample, class Sum>
  static std::array<Sum, block> sum(const std::vector<const Image*>& pictures, std::size_t first,
                                    std::size_t count) {
    std::array<Sum, block> sums{};
    Sample samples[block] = {};
    for (const Image* picture : pictures) {
      std::memcpy(samples, picture->bytes.data() + first * sizeof(Sample), count * sizeof(Sample));
      for (std::size_t i = 0; i < block; ++i) sums[i] = static_cast<Sum>(sums[i] + samples[i]);
    }
    return sums;
  }

  std::uint16_t mean(std::uint32_t sum) const {
    return static_cast<std::uint16_t>((sum + count_ / 2) / count_);
  }

  int bits_;
  std::uint32_t count_;
  std::vector<std::uint16_t> table_;  ///< by sum, of 8-bit samples
};

/// Room for an array that all of the scans have; who has it without room need not be appended to.
template <class T>
void reserve(std::vector<T>& all, const std::vector<std::shared_ptr<const Scan>>& scans,
             std::vector<T> Scan::*array) {
  std::size_t size = 0;
  for (const auto& scan : scans) {
    if (((*scan).*array).size() != scan->size()) return;
    size += scan->size();
  }
  all.reserve(size);
}

template <class T>
void append(std::vector<T>& all, const Scan& scan, std::vector<T> Scan::*array) {
  const std::vector<T>& more = scan.*array;
  if (all.capacity() > 0) all.insert(all.end(), more.begin(), more.end());
}

/// What `f` does with each of the arrays that are gathered.
template <class F>
void for_each_array(Scan& scan, F f) {
  f(scan.points, &Scan::points);
  f(scan.intensity, &Scan::intensity);
  f(scan.ring, &Scan::ring);
  f(scan.column, &Scan::column);
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
  std::vector<const Image*> alike;
  for (const CameraObservation* picture : pictures) {
    const Image& image = *picture->image;
    if (image.bits == first.bits && image.bytes.size() == first.bytes.size()) alike.push_back(&image);
  }
  const Means means(first.bits, static_cast<std::uint32_t>(alike.size()));
  const std::size_t samples = first.bytes.size() / static_cast<std::size_t>(first.bits / 8);
  Image mean{first.width, first.height, first.channels, 16, {}};
  mean.bytes.resize(2 * samples);
  for (std::size_t at = 0; at < samples; at += block) {
    means.put(alike, at, std::min(block, samples - at), mean.bytes.data() + 2 * at);
  }
  return mean;
}

Scan gathered_scan(std::vector<std::shared_ptr<const Scan>> scans) {
  Scan all;
  for_each_array(all, [&](auto& to, auto array) { reserve(to, scans, array); });
  for (std::shared_ptr<const Scan>& scan : scans) {
    for_each_array(all, [&](auto& to, auto array) { append(to, *scan, array); });
    all.rings = std::max(all.rings, scan->rings);
    all.columns = std::max(all.columns, scan->columns);
    scan.reset();
  }
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
