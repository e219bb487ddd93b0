// Eight channels at a time.
#include "drivers/lidar/velodyne/block_returns.h"

#include "drivers/lidar/lanes.h"

namespace ca2::detail {

CA2_LANES void project_velodyne_block(const VelodyneProjection::Block& block, const VelodyneBlockPlace& place,
                                      int lasers, FiredBeams& out) {
  const VelodyneProjection::Bank& bank = place.bank;
  for (int i = 0; i < lasers; i += lanes::count) {
    const auto at = static_cast<std::size_t>(i);
    lanes::Floats counts, turn_sine, turn_cosine, distance, cos_vertical, sin_vertical, v;
    lanes::load(counts, &block.counts[at]);
    lanes::load(turn_sine, &place.turned.sine[at]);
    lanes::load(turn_cosine, &place.turned.cosine[at]);
    lanes::load(distance, &bank.distance[at]);
    lanes::load(cos_vertical, &bank.cos_vertical[at]);
    lanes::load(sin_vertical, &bank.sin_vertical[at]);
    lanes::load(v, &bank.vertical_offset[at]);
    const lanes::Floats sine = place.sine * turn_cosine + place.cosine * turn_sine;
    const lanes::Floats cosine = place.cosine * turn_cosine - place.sine * turn_sine;
    const lanes::Floats range = counts * place.lsb + distance;
    const lanes::Floats flat = range * cos_vertical;
    lanes::Floats x = flat * sine, y = flat * cosine;
    if (place.sideways) {
      lanes::Floats h;
      lanes::load(h, &bank.horizontal_offset[at]);
      x = x - h * cosine;
      y = y + h * sine;
    }
    lanes::store(out.x + i, x);
    lanes::store(out.y + i, y);
    lanes::store(out.z + i, range * sin_vertical + v);
    lanes::store(out.range + i, range);
  }
}

}  // namespace ca2::detail
