/// @file Velodyne's data packets (1206 bytes) and position packets (512 bytes).
#include <algorithm>
#include <cmath>
#include <map>

#include "drivers/lidar/model.h"
#include "drivers/survey/little_endian.h"
#include "drivers/survey/recogniser.h"

namespace ca2 {
namespace {

using Payload = std::span<const std::uint8_t>;

constexpr std::size_t data_size = 1206, position_size = 512, blocks = 12, block_size = 100;
constexpr std::uint32_t microseconds_per_hour = 3'600'000'000u;

const char* return_mode_name(std::uint8_t mode) {
  switch (mode) {
    case 0x37:
      return "strongest";
    case 0x38:
      return "last";
    case 0x39:
      return "dual";
    case 0x3b:
      return "dual with confidence";
    default:
      return nullptr;
  }
}

/// us from packet to packet.
double packet_interval(const VelodyneModel& model, bool dual) {
  const double firings = static_cast<double>(blocks) * model.firings_per_block() / model.blocks_per_firing();
  return model.cycle * 1e6 * firings / (dual ? 2 : 1);
}

class VelodyneData : public Recogniser {
 public:
  void add(Payload packet, std::int64_t) override {
    ++packets_;
    ++endings_[{packet[1204], packet[1205]}];
    if (endings_.size() > most_endings) endings_.erase(endings_.begin());
    lower_blocks_ =
        lower_blocks_ || read_le(packet, 0, 2) == 0xddff || read_le(packet, block_size, 2) == 0xddff;
    const auto stamp = static_cast<std::uint32_t>(read_le(packet, 1200, 4));
    if (packets_ > 1 && stamp < microseconds_per_hour && stamp_ < microseconds_per_hour) {
      // Modulo the hour; what is not a step of at most some seconds forward says nothing of the interval.
      const std::uint32_t step = (stamp + microseconds_per_hour - stamp_) % microseconds_per_hour;
      if (step > 0 && step < 10'000'000) {
        ++steps_[step];
        if (steps_.size() > most_steps) steps_.erase(std::prev(steps_.end()));
      }
    }
    stamp_ = stamp;
  }

  StreamIdentity identity() const override {
    StreamIdentity identity;
    identity.vendor = "Velodyne";
    identity.kind = "lidar";
    // Every model but the HDL-64E has the same two bytes at the end of every packet.
    const bool fixed_ending =
        endings_.size() == 1 && return_mode_name(endings_.begin()->first.first) != nullptr;
    const bool old_ending = endings_.size() == 1 && !lower_blocks_;
    if (!fixed_ending && !old_ending) {
      identity.model = "HDL-64E";
      identity.details.push_back({"calibration", "needed: the angles are the unit's own"});
      return identity;
    }
    const auto [mode, product] = endings_.begin()->first;
    const char* mode_name = return_mode_name(mode);
    if (mode_name != nullptr) identity.details.push_back({"returns", mode_name});
    const double interval = usual_step();
    identity.model = model_name(product, mode == 0x39 || mode == 0x3b, interval);
    char text[8];
    std::snprintf(text, sizeof text, "0x%02x", product);
    identity.details.push_back({"product_id", text});
    if (interval > 0) identity.lost = lost(interval);
    return identity;
  }

 private:
  static constexpr std::size_t most_endings = 512, most_steps = 4096;

  /// The commonest step, us: loss only makes longer ones.
  double usual_step() const {
    const auto best = std::max_element(steps_.begin(), steps_.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return best == steps_.end() ? 0 : best->first;
  }

  std::uint64_t lost(double interval) const {
    double missing = 0;
    for (const auto& [step, count] : steps_) {
      missing += std::max(0.0, std::round(step / interval) - 1) * static_cast<double>(count);
    }
    return static_cast<std::uint64_t>(missing);
  }

  /// By the product id; where models share one (firmware of 2014), by the interval between packets.
  static std::string model_name(std::uint8_t product, bool dual, double interval) {
    std::string best;
    double best_distance = 0;
    for (const LidarModel& model : lidar_models()) {
      const VelodyneModel* velodyne = model.velodyne();
      if (velodyne == nullptr) continue;
      const auto& ids = velodyne->product_ids;
      if (std::find(ids.begin(), ids.end(), product) == ids.end()) continue;
      const double distance =
          interval > 0 ? std::abs(std::log(interval / packet_interval(*velodyne, dual))) : 0;
      if (best.empty() || distance < best_distance) {
        best = model.name;
        best_distance = distance;
      }
    }
    return best;
  }

  std::uint64_t packets_ = 0;
  std::uint32_t stamp_ = 0;
  bool lower_blocks_ = false;  ///< seen lasers 32-63 where only an HDL-64E starts with them
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::uint64_t> endings_;  ///< bytes 1204 and 1205
  std::map<std::uint32_t, std::uint64_t> steps_;                            ///< us between stamps, bounded
};

class VelodynePosition : public Recogniser {
 public:
  void add(Payload packet, std::int64_t) override { last_.assign(packet.begin(), packet.end()); }
  StreamIdentity identity() const override {
    StreamIdentity identity{"Velodyne", "", "position", {}, std::nullopt};
    if (last_.empty()) return identity;
    constexpr const char* pps[] = {"absent", "synchronizing", "locked", "error"};
    if (last_[202] < std::size(pps)) identity.details.push_back({"pps", pps[last_[202]]});
    identity.details.push_back({"nmea", last_[206] == '$' ? "yes" : "no"});
    return identity;
  }

 private:
  std::vector<std::uint8_t> last_;
};

bool is_data(Payload packet) {
  if (packet.size() != data_size) return false;
  for (std::size_t block = 0; block < 2; ++block) {
    const std::uint64_t flag = read_le(packet, block * block_size, 2);
    const bool known = flag == 0xeeff || flag == 0xddff || flag == 0xccff || flag == 0xbbff;
    if (!known || read_le(packet, block * block_size + 2, 2) >= 36000) return false;
  }
  return true;
}

/// Mostly zeros: what precedes the time stamp is empty but for an HDL-32E's gyros, and so is the tail.
bool is_position(Payload packet) {
  if (packet.size() != position_size) return false;
  const bool tail =
      std::all_of(packet.begin() + 400, packet.end(), [](std::uint8_t byte) { return byte == 0; });
  return tail && packet[202] <= 3 && (packet[206] == '$' || packet[206] == 0);
}

}  // namespace

std::unique_ptr<Recogniser> make_velodyne_recogniser(Payload packet) {
  if (is_data(packet)) return std::make_unique<VelodyneData>();
  if (is_position(packet)) return std::make_unique<VelodynePosition>();
  return nullptr;
}

}  // namespace ca2
