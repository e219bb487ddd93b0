#include "drivers/lidar/velodyne/packet.h"

#include <algorithm>
#include <bit>

namespace ca2 {
namespace {

using P = VelodynePacket;

/// Where each block of a packet belongs.
struct Place {
  int firing;  ///< of the packet's
  int ret;     ///< return: 0 is given out first; -1: holds no distances
};

using Layout = VelodyneLayout;

/// HDL-64E packets carry no return mode, but S2 and S3 send upper and lower block with one azimuth, twice
/// in a row with dual returns; an S1 sends three upper blocks and a lower one, each at its own azimuth.
Layout hdl_64e_layout(const std::uint8_t* packet) {
  bool paired = true, twice = true;
  for (int b = 0; b < P::blocks; b += 2) {
    const std::uint8_t* first = P::block(packet, b);
    const std::uint8_t* second = P::block(packet, b + 1);
    paired = paired && P::azimuth(first) == P::azimuth(second) && P::flag(first) != P::flag(second);
    if (b % 4 == 0) twice = twice && P::azimuth(first) == P::azimuth(P::block(packet, b + 2));
  }
  if (!paired) return Layout::apart;
  return twice ? Layout::groups : Layout::single;
}

/// `bits`: the number of banks is two to the power of these.
constexpr Place find_place(Layout layout, int block, int bits) {
  // With pairs and triples the strongest comes second on the wire and is given out first.
  constexpr int order[] = {1, 0, -1};
  switch (layout) {
    case Layout::single:
      return {block >> bits, 0};
    case Layout::pairs:
      return {block / 2 >> bits, order[block % 2]};
    case Layout::triples:
      return {block / 3 >> bits, order[block % 3]};
    case Layout::groups:
      return {block / 4, block / 2 % 2};
    case Layout::apart:
      return {block, 0};
  }
  return {0, -1};
}

using Places = std::array<Place, P::blocks>;

/// The same of all blocks, found once.
const Places& find_places(Layout layout, int bits) {
  constexpr std::size_t layouts = static_cast<std::size_t>(Layout::apart) + 1, bank_bits = 3;
  static constexpr auto all = [] {
    std::array<std::array<Places, bank_bits>, layouts> out{};
    for (std::size_t i = 0; i < layouts; ++i) {
      for (std::size_t j = 0; j < bank_bits; ++j) {
        for (std::size_t block = 0; block < P::blocks; ++block) {
          out[i][j][block] = find_place(static_cast<Layout>(i), static_cast<int>(block), static_cast<int>(j));
        }
      }
    }
    return out;
  }();
  return all[static_cast<std::size_t>(layout)][static_cast<std::size_t>(bits)];
}

int bits_of(int banks) {
  return std::countr_zero(static_cast<unsigned>(banks));
}

/// VLS-128, dual: one firing fills eight blocks, the rest of the packet is filler with flag 0.
int used_blocks(Layout layout, int banks) {
  return layout == Layout::pairs && banks == 4 ? 8 : P::blocks;
}

int signed_step(int from, int to) {
  int step = to - from;
  if (step < 0) step += P::azimuth_turn;
  if (step >= P::azimuth_turn) step -= P::azimuth_turn;
  return step > P::azimuth_turn / 2 ? step - P::azimuth_turn : step;
}

/// The mean step from block to block, which is finer than the 0.01 degree of the wire; the median where some
/// step is far off (a field of view begins, a block is damaged).
void steps_by_time(VelodyneFirings& firings) {
  const int n = firings.count - 1;
  if (n < 1) return;
  std::array<int, P::blocks> steps{};
  int least = P::azimuth_turn, most = -P::azimuth_turn, sum = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    steps[i] = signed_step(firings.firing[i].azimuth, firings.firing[i + 1].azimuth);
    least = std::min(least, steps[i]);
    most = std::max(most, steps[i]);
    sum += steps[i];
  }
  constexpr int jitter = 8;
  double step = static_cast<double>(sum) / n;
  if (most - least > jitter) {
    std::nth_element(steps.begin(), steps.begin() + n / 2, steps.begin() + n);
    step = steps[static_cast<std::size_t>(n / 2)];
  }
  for (int i = 0; i < firings.count; ++i) firings.firing[static_cast<std::size_t>(i)].step.fill(step);
}

using Steps = std::array<int, P::blocks - 1>;

/// What stands at `place` in order of size. A spinning head's steps are two or three numbers again and again,
/// so that to count what is smaller is quicker than to sort.
int in_order_of_size(const Steps& steps, int place) {
  for (const int step : steps) {
    int smaller = 0, not_larger = 0;
    for (const int other : steps) {
      smaller += other < step;
      not_larger += other <= step;
    }
    if (smaller <= place && place < not_larger) return step;
  }
  return 0;  // not reached: some number is always there
}

/// VeloView's: the seventh of the eleven steps from block to block in order of size, which is a step and not
/// a zero where blocks come in pairs.
void steps_of_veloview(VelodyneFirings& firings, const std::uint8_t* packet) {
  Steps steps;
  for (int b = 0; b + 1 < P::blocks; ++b) {
    steps[static_cast<std::size_t>(b)] =
        signed_step(P::azimuth(P::block(packet, b)), P::azimuth(P::block(packet, b + 1)));
  }
  const int step = in_order_of_size(steps, P::blocks / 2);
  for (int i = 0; i < firings.count; ++i) {
    VelodyneFiring& firing = firings.firing[static_cast<std::size_t>(i)];
    firing.step.fill(step);
    firing.rounded = true;
  }
}

void steps_by_block(VelodyneFirings& firings, Layout layout, int per_block, const std::uint8_t* packet) {
  const int ahead = layout == Layout::pairs ? 2 : layout == Layout::triples ? 3 : 1;
  const auto step_of = [&](int block) {
    if (block + ahead < P::blocks) {
      return signed_step(P::azimuth(P::block(packet, block)), P::azimuth(P::block(packet, block + ahead)));
    }
    return ahead > 1
               ? 0
               : signed_step(P::azimuth(P::block(packet, block - 1)), P::azimuth(P::block(packet, block)));
  };
  // The last block takes its predecessor's step, which it lies at the end of.
  for (int i = 0; i < firings.count; ++i) {
    VelodyneFiring& firing = firings.firing[static_cast<std::size_t>(i)];
    for (std::size_t bank = 0; bank < 4; ++bank) {
      const std::uint8_t* block = firing.blocks[0][bank] ? firing.blocks[0][bank] : firing.blocks[1][bank];
      if (!block) continue;
      firing.step[bank] =
          step_of(static_cast<int>((block - packet) / static_cast<std::ptrdiff_t>(P::block_bytes)));
    }
    if (layout == Layout::pairs && per_block == 2) {
      firing.strongest_ahead = static_cast<int>(firing.step[0]);
    }
  }
}

}  // namespace

int velodyne_bank(std::uint16_t flag) {
  for (int bank = 0; bank < 4; ++bank) {
    if (P::bank_flags[bank] == flag) return bank;
  }
  return -1;
}

std::optional<VelodyneLayout> find_velodyne_layout(const VelodyneModel& model, const std::uint8_t* packet) {
  if (model.dual == VelodyneDual::groups) return hdl_64e_layout(packet);
  const auto same = [&](int a, int b) {
    return P::azimuth(P::block(packet, a)) == P::azimuth(P::block(packet, b));
  };
  switch (P::return_mode(packet)) {
    case P::mode_strongest:
    case P::mode_last:
      return Layout::single;
    case P::mode_dual:
      return Layout::pairs;
    case P::mode_dual_confidence:
      // Last, strongest, confidence of one firing; any other arrangement is not known.
      if (same(0, 1) && same(1, 2)) return Layout::triples;
      return std::nullopt;
    default:
      // Firmware from before the byte existed: only the azimuths tell.
      return same(0, 1) && model.lasers <= 32 ? Layout::pairs : Layout::single;
  }
}

int velodyne_cycles(const VelodyneModel& model, VelodyneLayout layout) {
  const int banks = layout == Layout::apart ? 1 : model.blocks_per_firing();
  return (find_place(layout, used_blocks(layout, banks) - 1, bits_of(banks)).firing + 1) *
         model.firings_per_block();
}

void read_velodyne_firings(const VelodyneModel& model, VelodyneLayout layout, VelodyneAzimuth azimuth_mode,
                           const std::uint8_t* packet, VelodyneFirings& out) {
  const int banks = layout == Layout::apart ? 1 : model.blocks_per_firing();
  const int per_block = model.firings_per_block();
  const Places& places = find_places(layout, bits_of(banks));
  out.count = out.bad_blocks = 0;
  std::array<bool, VelodyneFirings::most> seen{};
  int last = -1;
  for (int b = 0; b < used_blocks(layout, banks); ++b) {
    const std::uint8_t* block = P::block(packet, b);
    const Place place = places[static_cast<std::size_t>(b)];
    const int bank = velodyne_bank(P::flag(block));
    const int azimuth = P::azimuth(block);
    if (bank < 0 || bank * P::channels >= std::max(model.lasers, P::channels) || azimuth >= P::azimuth_turn) {
      ++out.bad_blocks;
      continue;
    }
    const auto at = static_cast<std::size_t>(place.firing);
    VelodyneFiring& firing = out.firing[at];
    if (!seen[at]) {
      seen[at] = true;
      firing.azimuth = azimuth;
      firing.cycle = place.firing * per_block;
      firing.step.fill(0);
      firing.rounded = false;
      firing.strongest_ahead.reset();
      for (auto& blocks : firing.blocks) blocks.fill(nullptr);
    }
    if (place.ret >= 0)
      firing.blocks[static_cast<std::size_t>(place.ret)][static_cast<std::size_t>(bank)] = block;
    last = std::max(last, place.firing);
  }
  // Firings whose blocks were all damaged close up; their times stay what they were.
  for (int i = 0; i <= last; ++i) {
    if (!seen[static_cast<std::size_t>(i)]) continue;
    if (i > out.count)
      out.firing[static_cast<std::size_t>(out.count)] = out.firing[static_cast<std::size_t>(i)];
    ++out.count;
  }
  if (layout == Layout::apart) return;  // when the lasers of an S1 fire is not published
  if (azimuth_mode == VelodyneAzimuth::published) {
    const bool by_block = banks == 4 || (layout == Layout::pairs && per_block == 2);
    azimuth_mode = by_block ? VelodyneAzimuth::blocks : VelodyneAzimuth::veloview;
  }
  switch (azimuth_mode) {
    case VelodyneAzimuth::veloview:
      steps_of_veloview(out, packet);
      break;
    case VelodyneAzimuth::blocks:
      steps_by_block(out, layout, per_block, packet);
      break;
    default:
      steps_by_time(out);
  }
}

bool velodyne_other_model(const VelodyneModel& model, const std::uint8_t* packet) {
  if (model.product_ids.empty()) return false;
  const std::uint8_t id = P::product_id(packet);
  // 0: firmware from before the byte existed.
  if (id != 0 &&
      std::find(model.product_ids.begin(), model.product_ids.end(), id) == model.product_ids.end()) {
    return true;
  }
  if (model.lasers > 32) return false;
  for (int b = 0; b < P::blocks; ++b) {
    const std::uint16_t flag = P::flag(P::block(packet, b));
    if (flag != P::bank_flags[0] && velodyne_bank(flag) > 0) return true;
  }
  return false;
}

}  // namespace ca2
