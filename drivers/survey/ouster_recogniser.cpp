/// @file Ouster's lidar, IMU and zone packets. Sizes collide between profiles; that measurement ids run on
/// from column to column tells those apart whose columns differ in size.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "drivers/lidar/ouster/profile.h"
#include "drivers/survey/little_endian.h"
#include "drivers/survey/recogniser.h"

namespace ca2 {
namespace {

using Payload = std::span<const std::uint8_t>;

constexpr std::size_t columns_per_packet = 16;  // the only value seen
constexpr std::uint64_t most_columns = 4096;    // of a frame, in any lidar mode

/// A way the datagrams could be cut up.
struct Layout {
  const OusterProfile* profile = nullptr;
  std::size_t beams = 0;

  std::size_t column_size() const {
    return static_cast<std::size_t>(profile->column_header() + profile->column_footer()) +
           beams * static_cast<std::size_t>(profile->pixel_bytes);
  }
  std::size_t packet_size() const {
    return static_cast<std::size_t>(profile->packet_header() + profile->packet_footer()) +
           columns_per_packet * column_size();
  }
  std::uint64_t measurement_id(Payload packet, std::size_t column) const {
    return read_le(packet, static_cast<std::size_t>(profile->packet_header()) + column * column_size() + 8,
                   2);
  }

  bool fits(Payload packet) const {
    if (packet.size() != packet_size()) return false;
    const std::uint64_t first = measurement_id(packet, 0);
    if (first >= most_columns) return false;
    for (std::size_t column = 1; column < columns_per_packet; ++column) {
      if (measurement_id(packet, column) != first + column) return false;
    }
    return profile->legacy() || packet[0] == 1;  // packet type: lidar
  }
};

std::vector<Layout> layouts_of(Payload packet) {
  std::vector<Layout> fitting;
  for (const OusterProfile& profile : ouster_profiles()) {
    for (const std::size_t beams : {16, 32, 64, 128}) {
      const Layout layout{&profile, beams};
      if (layout.fits(packet)) fitting.push_back(layout);
    }
  }
  return fitting;
}

/// The header of functional safety puts the serial number where the other one has zeros.
bool fusa_header(Payload packet) {
  return packet[13] != 0 || packet[14] != 0 || packet[15] != 0;
}

void add_header_details(Payload packet, StreamIdentity& identity) {
  const bool fusa = fusa_header(packet);
  identity.details.push_back({"serial", std::to_string(read_le(packet, fusa ? 11 : 7, 5))});
  identity.details.push_back({"init_id", std::to_string(read_le(packet, fusa ? 1 : 4, 3))});
  if (fusa) identity.details.push_back({"header", "FUSA"});
}

class OusterLidar : public Recogniser {
 public:
  explicit OusterLidar(Payload packet) : layouts_(layouts_of(packet)) {}
  bool possible() const { return !layouts_.empty(); }

  void add(Payload packet, std::int64_t) override {
    std::vector<Layout> still;
    std::copy_if(layouts_.begin(), layouts_.end(), std::back_inserter(still),
                 [&](const Layout& layout) { return layout.fits(packet); });
    if (still.empty()) {
      ++misfits_;  // a foreign datagram of the same size, or a damaged one
      return;
    }
    layouts_ = still;
    last_.assign(packet.begin(), packet.end());
    const std::uint64_t frame = frame_id(packet);
    if (frames_ == 0 || frame != frame_) {
      frame_ = frame;
      in_frame_ = 0;
      if (++frames_ == 2) inner_ = 0;  // the first frame is partial
    }
    ++in_frame_;
    ++inner_;
    places_.insert(layouts_[0].measurement_id(packet, 0));
  }

  StreamIdentity identity() const override {
    StreamIdentity identity;
    identity.vendor = "Ouster";
    identity.kind = "lidar";
    std::set<std::size_t> beams;
    std::string profiles;
    for (const Layout& layout : layouts_) {
      beams.insert(layout.beams);
      profiles += (profiles.empty() ? "" : " or ") + std::string(layout.profile->name);
    }
    for (const std::size_t count : beams) {
      identity.model += (identity.model.empty() ? "" : " or ") + std::to_string(count);
    }
    identity.model += " beams";
    identity.details.push_back({"profile", profiles});
    if (!layouts_[0].profile->legacy() && !last_.empty()) add_header_details(last_, identity);
    identity.details.push_back({"columns", std::to_string(columns())});
    if (misfits_ > 0) identity.details.push_back({"foreign", std::to_string(misfits_)});
    // Between the first and the last frame, which are partial, every place of a packet is due once a frame.
    if (frames_ > 2) {
      const std::uint64_t due = (frames_ - 2) * places_.size();
      const std::uint64_t got = inner_ - in_frame_;
      identity.lost = due > got ? due - got : 0;
    }
    return identity;
  }

 private:
  std::uint64_t frame_id(Payload packet) const {
    if (layouts_[0].profile->legacy()) return read_le(packet, 10, 2);
    return fusa_header(packet) ? read_le(packet, 4, 4) : read_le(packet, 2, 2);
  }
  /// Of the lidar mode: the first that has room for every column seen.
  std::uint64_t columns() const {
    const std::uint64_t least = places_.empty() ? 0 : *places_.rbegin() + columns_per_packet;
    std::uint64_t columns = 512;
    while (columns < least) columns *= 2;
    return columns;
  }

  std::vector<Layout> layouts_;
  std::vector<std::uint8_t> last_;
  std::set<std::uint64_t> places_;  ///< measurement ids packets start with: at most most_columns
  std::uint64_t frame_ = 0, frames_ = 0, in_frame_ = 0, inner_ = 0, misfits_ = 0;
};

/// Packets that say little: their kind is all there is to tell.
class OusterOther : public Recogniser {
 public:
  OusterOther(const char* kind, bool header) : kind_(kind), header_(header) {}
  void add(Payload packet, std::int64_t) override { last_.assign(packet.begin(), packet.end()); }
  StreamIdentity identity() const override {
    StreamIdentity identity{"Ouster", "", kind_, {}, std::nullopt};
    if (header_ && !last_.empty()) add_header_details(last_, identity);
    return identity;
  }

 private:
  const char* kind_;
  bool header_;
  std::vector<std::uint8_t> last_;
};

/// 48 bytes: three time stamps, acceleration in g, angular rate in deg/s. A sensor at work feels about 1 g.
bool is_legacy_imu(Payload packet) {
  if (packet.size() != 48) return false;
  double squares = 0;
  for (const std::size_t at : {24, 28, 32}) {
    float g = 0;
    std::memcpy(&g, packet.data() + at, sizeof g);
    squares += static_cast<double>(g) * static_cast<double>(g);
  }
  return std::isfinite(squares) && squares > 0.1 && squares < 100;
}

}  // namespace

std::unique_ptr<Recogniser> make_ouster_recogniser(Payload packet) {
  if (is_legacy_imu(packet)) return std::make_unique<OusterOther>("IMU", false);
  // 32 of header, 100 of NMEA, 36 a measurement, 32 of footer.
  constexpr std::size_t imu_frame = 32 + 100 + 32, imu_measurement = 36, zone_packet = 680;
  if (packet.size() > imu_frame && (packet.size() - imu_frame) % imu_measurement == 0 && packet[0] == 2 &&
      packet[1] == 0) {
    return std::make_unique<OusterOther>("IMU", true);
  }
  if (packet.size() == zone_packet && packet[0] == 3) return std::make_unique<OusterOther>("zone", true);
  auto lidar = std::make_unique<OusterLidar>(packet);
  if (lidar->possible()) return lidar;
  return nullptr;
}

}  // namespace ca2
