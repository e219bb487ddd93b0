#include "drivers/lidar/velodyne/streamed_calibration.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string_view>

#include "drivers/lidar/bytes.h"

namespace ca2 {
namespace {

// HDL-64E S3 User Manual, appendix "Calibration values in the data stream".
constexpr std::string_view mark = "UNIT#";
constexpr std::size_t first_record = 7, record_bytes = 28;
constexpr int lasers = 64;
constexpr std::uint16_t s2_checksum = 1820;

/// CRC-16, polynomial 0x8005, most significant bit first, from 0, over what follows each record's id.
std::uint16_t checksum(std::span<const std::uint8_t> table) {
  unsigned crc = 0;
  for (int i = 0; i < lasers; ++i) {
    const std::uint8_t* record = table.data() + first_record + static_cast<std::size_t>(i) * record_bytes;
    for (int k = 1; k <= 20; ++k) {
      crc ^= static_cast<unsigned>(record[k]) << 8;
      for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000u) != 0 ? (crc << 1) ^ 0x8005u : crc << 1;
      crc &= 0xFFFFu;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

/// The 16 bit corrections of a record, in their order, with the unit of a step in SI.
constexpr double centidegree = std::numbers::pi / 18000, millimetre = 1e-3;
struct Step {
  double VelodyneLaser::*member;
  double unit;
};
constexpr Step steps[] = {
    {&VelodyneLaser::vertical, centidegree},
    {&VelodyneLaser::rotation, centidegree},
    {&VelodyneLaser::distance, millimetre},
    {&VelodyneLaser::distance_x, millimetre},
    {&VelodyneLaser::distance_y, millimetre},
    {&VelodyneLaser::vertical_offset, millimetre},
    {&VelodyneLaser::horizontal_offset, millimetre},
    {&VelodyneLaser::focal_distance, millimetre},
    {&VelodyneLaser::focal_slope, 0.1},
};

}  // namespace

std::optional<VelodyneCalibration> StreamedCalibration::push(std::uint8_t type, std::uint8_t value) {
  // Every other type carries the date, GPS status, temperature or firmware version.
  if (std::string_view("HMSDNYGTV").find(static_cast<char>(type)) != std::string_view::npos)
    return std::nullopt;
  bytes_.push_back(value);
  const auto fits = [&] {
    const std::size_t n = std::min(bytes_.size(), mark.size());
    return std::memcmp(bytes_.data(), mark.data(), n) == 0;
  };
  while (!bytes_.empty() && !fits()) bytes_.erase(bytes_.begin());
  if (bytes_.size() < table_bytes) return std::nullopt;
  const auto calibration = parse_streamed_calibration(bytes_);
  bytes_.clear();
  return calibration;
}

std::optional<VelodyneCalibration> parse_streamed_calibration(std::span<const std::uint8_t> table) {
  if (table.size() != StreamedCalibration::table_bytes) return std::nullopt;
  const auto written = load<std::uint16_t>(table.data() + table.size() - 2);
  if (written != s2_checksum && written != checksum(table)) return std::nullopt;
  VelodyneCalibration out;
  out.lasers.resize(lasers);
  std::vector<bool> seen(lasers);
  for (int i = 0; i < lasers; ++i) {
    const std::uint8_t* record = table.data() + first_record + static_cast<std::size_t>(i) * record_bytes;
    if (record[0] >= lasers || seen[record[0]]) return std::nullopt;
    seen[record[0]] = true;
    VelodyneLaser& laser = out.lasers[record[0]];
    const std::uint8_t* at = record + 1;
    for (const Step& step : steps) {
      laser.*step.member = load<std::int16_t>(at) * step.unit;
      at += 2;
    }
    laser.min_intensity = at[0];
    laser.max_intensity = at[1];
  }
  return out;
}

std::vector<std::uint8_t> write_streamed_calibration(const VelodyneCalibration& calibration) {
  std::vector<std::uint8_t> table(StreamedCalibration::table_bytes);
  std::copy(mark.begin(), mark.end(), table.begin());
  for (std::size_t id = 0; id < calibration.lasers.size() && id < lasers; ++id) {
    const VelodyneLaser& laser = calibration.lasers[id];
    std::uint8_t* at = table.data() + first_record + id * record_bytes;
    *at++ = static_cast<std::uint8_t>(id);
    for (const Step& step : steps) {
      const double value = std::clamp(std::round(laser.*step.member / step.unit), -32768.0, 32767.0);
      store(at, static_cast<std::int16_t>(value));
      at += 2;
    }
    at[0] = static_cast<std::uint8_t>(std::clamp(laser.min_intensity, 0, 255));
    at[1] = static_cast<std::uint8_t>(std::clamp(laser.max_intensity, 0, 255));
  }
  store(table.data() + table.size() - 2, checksum(table));
  return table;
}

}  // namespace ca2
