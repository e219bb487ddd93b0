#include "drivers/lidar/impair.h"

#include <algorithm>

namespace ca2 {
namespace {

/// [0, 1), the same on every standard library, unlike std::uniform_real_distribution.
double unit(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace

std::vector<EncodedPacket> impair(const std::vector<EncodedPacket>& packets, const Impairment& impairment,
                                  std::mt19937_64& random) {
  std::vector<EncodedPacket> out;
  for (const EncodedPacket& packet : packets) {
    if (unit(random) < impairment.loss) continue;
    out.push_back(packet);
    if (unit(random) < impairment.duplication) out.push_back(packet);
  }
  if (impairment.reorder < 2) return out;
  std::vector<std::int64_t> times;
  for (const EncodedPacket& packet : out) times.push_back(packet.time);
  for (std::size_t first = 0; first < out.size(); first += impairment.reorder) {
    const std::size_t end = std::min(first + impairment.reorder, out.size());
    for (std::size_t i = end; i > first + 1; --i) {
      const std::size_t j = first + static_cast<std::size_t>(unit(random) * static_cast<double>(i - first));
      std::swap(out[i - 1], out[j]);
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) out[i].time = times[i];
  return out;
}

}  // namespace ca2
