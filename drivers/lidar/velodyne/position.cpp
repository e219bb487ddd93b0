#include "drivers/lidar/velodyne/position.h"

#include <charconv>
#include <chrono>
#include <vector>

#include "drivers/lidar/velodyne/packet.h"

namespace ca2 {
namespace {

// VLP-16 User Manual, section 9.4 "Position Packet Structure".
constexpr std::size_t time_at = 198, pps_at = 202, nmea_at = 206, nmea_most = 128;

bool checksum_fits(std::string_view sentence) {
  const std::size_t star = sentence.find('*');
  if (star == std::string_view::npos || star + 3 > sentence.size()) return false;
  unsigned sum = 0, written = 0;
  for (const char c : sentence.substr(1, star - 1)) sum ^= static_cast<unsigned char>(c);
  const char* digits = sentence.data() + star + 1;
  const auto [end, error] = std::from_chars(digits, digits + 2, written, 16);
  return error == std::errc() && end == digits + 2 && written == sum;
}

std::vector<std::string_view> split(std::string_view sentence) {
  std::vector<std::string_view> fields;
  std::size_t from = 0;
  for (std::size_t comma = sentence.find(','); comma != std::string_view::npos;
       comma = sentence.find(',', from)) {
    fields.push_back(sentence.substr(from, comma - from));
    from = comma + 1;
  }
  fields.push_back(sentence.substr(from));
  return fields;
}

/// Decimal digits [from, from + count) of a field; -1: not there.
int digits(std::string_view field, std::size_t from, std::size_t count) {
  int value = -1;
  if (field.size() < from + count) return -1;
  const char* first = field.data() + from;
  const auto [end, error] = std::from_chars(first, first + count, value);
  return error == std::errc() && end == first + count && value >= 0 ? value : -1;
}

/// "3707.8178" with two (latitude) or three digits of degrees.
double degrees(std::string_view field, std::string_view hemisphere, std::size_t whole) {
  const int deg = digits(field, 0, whole);
  double minutes = 0;
  if (deg < 0) return 0;
  std::from_chars(field.data() + whole, field.data() + field.size(), minutes);
  const double value = deg + minutes / 60;
  return hemisphere == "S" || hemisphere == "W" ? -value : value;
}

std::int64_t utc_of(std::string_view time, std::string_view date) {
  using namespace std::chrono;
  const int hour = digits(time, 0, 2), minute = digits(time, 2, 2), second = digits(time, 4, 2);
  const int d = digits(date, 0, 2), m = digits(date, 2, 2), y = digits(date, 4, 2);
  if (hour < 0 || minute < 0 || second < 0 || d < 0 || m < 0 || y < 0) return 0;
  const year_month_day day{year(2000 + y), month(static_cast<unsigned>(m)),
                           std::chrono::day(static_cast<unsigned>(d))};
  if (!day.ok()) return 0;
  const auto since = sys_days(day).time_since_epoch() + hours(hour) + minutes(minute) + seconds(second);
  return duration_cast<nanoseconds>(since).count();
}

}  // namespace

std::optional<VelodynePosition> parse_velodyne_position(std::span<const std::uint8_t> packet) {
  if (packet.size() != VelodynePacket::position_bytes) return std::nullopt;
  VelodynePosition out;
  out.us_of_hour = load<std::uint32_t>(packet.data() + time_at);
  out.pps = packet[pps_at] <= 3 ? static_cast<VelodynePps>(packet[pps_at]) : VelodynePps::error;
  const std::string_view text(reinterpret_cast<const char*>(packet.data()) + nmea_at, nmea_most);
  const std::string_view sentence = text.substr(0, text.find_first_of(std::string_view("\r\n\0", 3)));
  if (!sentence.starts_with('$') || !checksum_fits(sentence)) return out;
  out.nmea = sentence;
  const std::vector<std::string_view> fields = split(sentence);
  if (fields[0].size() < 6 || fields[0].substr(3) != "RMC" || fields.size() < 10) return out;
  out.valid = fields[2] == "A";
  out.latitude = degrees(fields[3], fields[4], 2);
  out.longitude = degrees(fields[5], fields[6], 3);
  out.utc = utc_of(fields[1], fields[9]);
  return out;
}

}  // namespace ca2
