#include "tools/ca2/robot_messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "core/types/text.h"
#include "drivers/camera/pixel_formats/pixel_format.h"

namespace ca2 {
namespace {

constexpr std::uint64_t image_fingerprint = 0x14739ffe13d5f5f0;
constexpr std::uint64_t cloud_fingerprint = 0x0d89dc76eb295069;
constexpr std::uint64_t pronto_cloud_fingerprint = 0x28885940907521d1;  // channels by point
constexpr std::uint64_t cloud2_fingerprint = 0x0bcd5ce4bf5a1b4a;

/// Big-endian values in the order of the wire. Reading beyond the end gives zeros and makes `good` false,
/// once and for all.
class Wire {
 public:
  explicit Wire(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool good() const { return good_; }
  std::size_t left() const { return bytes_.size() - at_; }

  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    for (const std::uint8_t byte : bytes(size)) value = value << 8 | byte;
    return value;
  }
  std::int64_t i64() { return static_cast<std::int64_t>(number(8)); }
  std::int32_t i32() { return static_cast<std::int32_t>(number(4)); }
  float f32() { return std::bit_cast<float>(static_cast<std::uint32_t>(number(4))); }
  /// How many things of at least `size` bytes follow; false where there is no room for them.
  std::size_t count(std::size_t size) {
    const std::int32_t value = i32();
    if (value < 0 || static_cast<std::size_t>(value) > left() / size) good_ = false;
    return good_ ? static_cast<std::size_t>(value) : 0;
  }
  std::span<const std::uint8_t> bytes(std::size_t size) {
    if (size > left()) good_ = false;
    if (!good_) return {};
    at_ += size;
    return bytes_.subspan(at_ - size, size);
  }
  /// Its length counts the zero at its end.
  std::string text() {
    const auto content = bytes(count(1));
    if (content.empty()) good_ = false;
    return good_ ? std::string(content.begin(), content.end() - 1) : std::string();
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

/// The type's codes of what our own formats have too.
const PixelFormat* pixel_format(std::int32_t code) {
  struct Row {
    std::int32_t code;
    const char* name;
  };
  static constexpr Row rows[] = {{0, "Mono8"},  // what old drivers leave
                                 {1497715271, "Mono8"},
                                 {909199180, "Mono16"},
                                 {859981650, "RGB8"},
                                 {861030210, "BGR8"},
                                 {825770306, "BayerBG8"},
                                 {844650584, "BayerGB8"},
                                 {861427800, "BayerGR8"},
                                 {878205016, "BayerRG8"},
                                 {826360396, "BayerBG16"},
                                 {843137612, "BayerGB16"},
                                 {859914828, "BayerGR16"},
                                 {876692044, "BayerRG16"},
                                 {1448695129, "YUV422_8"},
                                 {1498831189, "YUV422_8_UYVY"},
                                 {842094158, "NV12"},
                                 {1196444237, "MJPG"}};
  for (const Row& row : rows) {
    if (row.code == code) return find_pixel_format(row.name);
  }
  return nullptr;
}

/// Names that fields of clouds go by.
enum class Field { x, y, z, intensity, ring, other };

Field field_of(std::string_view name) {
  if (name == "x") return Field::x;
  if (name == "y") return Field::y;
  if (name == "z") return Field::z;
  if (name == "intensity" || name == "intensities" || name == "i" || name == "reflectivity")
    return Field::intensity;
  if (name == "ring" || name == "rings" || name == "laser_id") return Field::ring;
  return Field::other;
}

std::uint16_t ring_number(double value) {
  return static_cast<std::uint16_t>(std::clamp(std::isfinite(value) ? value : 0.0, 0.0, 65535.0));
}

Result<Scan> decode_floats(Wire& wire, bool by_point, const std::string& name) {
  wire.i32();   // sequence number
  wire.text();  // frame
  Scan scan;
  const std::size_t count = wire.count(12);
  scan.points.resize(count);
  for (Eigen::Vector3f& p : scan.points) {
    for (int k = 0; k < 3; ++k) p(k) = wire.f32();
  }
  std::vector<Field> fields(wire.count(5));
  for (Field& field : fields) field = field_of(wire.text());
  if (!wire.good() || wire.left() / 4 / std::max<std::size_t>(count, 1) < fields.size())
    return fail(ErrorCode::data, name, "the message is cut short");
  for (const Field field : fields) {
    if (field == Field::intensity) scan.intensity.resize(count);
    if (field == Field::ring) scan.ring.resize(count);
  }
  for (std::size_t i = 0; i < count * fields.size(); ++i) {
    const std::size_t point = by_point ? i / fields.size() : i % count;
    const Field field = fields[by_point ? i % fields.size() : i / count];
    const float value = wire.f32();
    if (field == Field::intensity) scan.intensity[point] = value;
    if (field == Field::ring) scan.ring[point] = ring_number(static_cast<double>(value));
  }
  return scan;
}

/// A field of a point as ROS's PointField says it: 1 to 8 are int8, uint8, int16, uint16, int32, uint32,
/// float, double.
double field_value(std::span<const std::uint8_t> bytes, int type, bool big_endian) {
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k < bytes.size(); ++k)
    bits |= std::uint64_t{bytes[big_endian ? bytes.size() - 1 - k : k]} << 8 * k;
  switch (type) {
    case 1:
      return static_cast<std::int8_t>(bits);
    case 3:
      return static_cast<std::int16_t>(bits);
    case 5:
      return static_cast<std::int32_t>(bits);
    case 7:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    case 8:
      return std::bit_cast<double>(bits);
    default:
      return static_cast<double>(bits);
  }
}

Result<Scan> decode_fields(Wire& wire, const std::string& name) {
  struct Place {
    Field field = Field::other;
    std::size_t offset = 0, size = 0;
    int type = 0;
  };
  static constexpr std::size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  wire.i32();   // sequence number
  wire.text();  // frame
  const std::int64_t height = wire.i32(), width = wire.i32();
  std::vector<Place> places(wire.count(14));
  for (Place& place : places) {
    place.field = field_of(wire.text());
    const std::int32_t offset = wire.i32();
    place.type = static_cast<int>(wire.number(1));
    const std::int32_t repeated = wire.i32();
    if (offset < 0 || place.type < 1 || place.type > 8 || repeated < 0)
      return fail(ErrorCode::data, name, "a field of its points is none of PointField's");
    place.offset = static_cast<std::size_t>(offset);
    place.size = sizes[place.type];
  }
  const bool big_endian = wire.number(1) != 0;
  const std::int64_t step = wire.i32(), row = wire.i32();
  const auto data = wire.bytes(wire.count(1));
  if (!wire.good()) return fail(ErrorCode::data, name, "the message is cut short");
  std::optional<Place> by_field[5];
  for (const Place& place : places) {
    if (place.field == Field::other) continue;
    if (place.offset + place.size > static_cast<std::size_t>(std::max<std::int64_t>(step, 0)))
      return fail(ErrorCode::data, name, "a field lies outside its point");
    by_field[static_cast<std::size_t>(place.field)] = place;
  }
  if (!by_field[0] || !by_field[1] || !by_field[2])
    return fail(ErrorCode::data, name, "its points have no x, y and z");
  if (height < 0 || width < 0 ||
      (height > 0 && width > 0 &&
       (row < width * step || (height - 1) * row + width * step > static_cast<std::int64_t>(data.size()))))
    return fail(ErrorCode::data, name, "it has fewer points than it says");
  Scan scan;
  const auto value = [&](std::size_t field, std::size_t point) {
    const Place& place = *by_field[field];
    return field_value(data.subspan(point + place.offset, place.size), place.type, big_endian);
  };
  for (std::int64_t v = 0; v < height; ++v) {
    for (std::int64_t u = 0; u < width; ++u) {
      const auto point = static_cast<std::size_t>(v * row + u * step);
      scan.points.emplace_back(static_cast<float>(value(0, point)), static_cast<float>(value(1, point)),
                               static_cast<float>(value(2, point)));
      if (by_field[3]) scan.intensity.push_back(static_cast<float>(value(3, point)));
      if (by_field[4]) scan.ring.push_back(ring_number(value(4, point)));
    }
  }
  return scan;
}

}  // namespace

RobotMessage kind_of_message(std::span<const std::uint8_t> message) {
  Wire wire(message);
  const std::uint64_t fingerprint = wire.number(8);
  if (fingerprint == image_fingerprint) return RobotMessage::picture;
  const bool cloud = fingerprint == cloud_fingerprint || fingerprint == pronto_cloud_fingerprint ||
                     fingerprint == cloud2_fingerprint;
  return cloud ? RobotMessage::cloud : RobotMessage::other;
}

std::int64_t message_utime(std::span<const std::uint8_t> message) {
  Wire wire(message);
  wire.number(8);
  return wire.i64();
}

Result<Image> decode_picture_message(std::span<const std::uint8_t> message, const std::string& name) {
  Wire wire(message);
  if (wire.number(8) != image_fingerprint) return fail(ErrorCode::data, name, "is no bot_core.image_t");
  wire.i64();
  RawPicture raw;
  raw.width = wire.i32();
  raw.height = wire.i32();
  const std::int32_t stride = wire.i32(), code = wire.i32();
  raw.data = wire.bytes(wire.count(1));
  if (!wire.good()) return fail(ErrorCode::data, name, "the message is cut short");
  raw.format = pixel_format(code);
  if (!raw.format) {
    return fail(ErrorCode::data, name, formatted("its pixel format %d is not read", code),
                "log grey, RGB, Bayer, YUYV or JPEG pictures");
  }
  if (raw.width <= 0 || raw.height <= 0 || raw.width > 30000 || raw.height > 30000 || stride < 0)
    return fail(ErrorCode::data, name, "its size is no picture's");
  // Of JPEG, drivers leave anything there.
  raw.stride = raw.format->name == "MJPG" ? 0 : static_cast<std::size_t>(stride);
  Result<Image> image = to_image(raw, PictureKind::colour);
  if (!image) return fail(ErrorCode::data, name, image.error().problems.front().what);
  return image;
}

Result<Scan> decode_cloud_message(std::span<const std::uint8_t> message, const std::string& name) {
  Wire wire(message);
  const std::uint64_t fingerprint = wire.number(8);
  wire.i64();
  if (fingerprint == cloud2_fingerprint) return decode_fields(wire, name);
  if (fingerprint == cloud_fingerprint || fingerprint == pronto_cloud_fingerprint)
    return decode_floats(wire, fingerprint == pronto_cloud_fingerprint, name);
  return fail(ErrorCode::data, name, "is no point cloud");
}

}  // namespace ca2
