#include "tools/ca2/import_log.h"

#include <lcm/eventlog.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "tools/ca2/nearest_pairs.h"
#include "tools/ca2/robot_messages.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

using Event = std::unique_ptr<lcm_eventlog_event_t, decltype(&lcm_eventlog_free_event)>;

class Log {
 public:
  explicit Log(const fs::path& file) : log_(lcm_eventlog_create(file.c_str(), "r"), &lcm_eventlog_destroy) {
    std::error_code error;
    size_ = fs::file_size(file, error);
    if (error) size_ = 0;
  }

  bool open() const { return log_ != nullptr; }
  std::int64_t position() const { return ftello(log_->f); }
  bool go_to(std::int64_t at) const { return fseeko(log_->f, at, SEEK_SET) == 0; }
  /// The next one; none at the end, and where the log is damaged.
  Event next() const {
    return {fits() ? lcm_eventlog_read_next_event(log_.get()) : nullptr, &lcm_eventlog_free_event};
  }

 private:
  /// Is the next event's data in the file? liblcm takes as much memory as it is told, and does not look
  /// whether it got any.
  bool fits() const {
    constexpr std::uint32_t magic = 0xEDA1DA01;
    const std::int64_t begin = position();
    std::uint32_t last = 0;
    for (int byte = 0; last != magic && (byte = std::fgetc(log_->f)) != EOF;)
      last = last << 8 | static_cast<std::uint32_t>(byte);
    std::uint8_t header[24] = {};  // number, time, lengths of channel and data
    const bool whole = std::fread(header, 1, sizeof header, log_->f) == sizeof header;
    std::uint32_t length = 0;
    for (std::size_t i = 20; i < sizeof header; ++i) length = length << 8 | header[i];
    return whole && length <= size_ && go_to(begin);
  }

  std::unique_ptr<lcm_eventlog_t, decltype(&lcm_eventlog_destroy)> log_;
  std::uintmax_t size_ = 0;
};

std::span<const std::uint8_t> bytes_of(const Event& event) {
  return {static_cast<const std::uint8_t*>(event->data),
          static_cast<std::size_t>(std::max(event->datalen, 0))};
}

/// us. Drivers without a clock leave 0, damage leaves what has no ns of 64 bits: then the time it was logged
/// has to do, or none.
std::int64_t time_of(const Event& event) {
  for (const std::int64_t time : {message_utime(bytes_of(event)), event->timestamp}) {
    if (time > 0 && time <= std::numeric_limits<std::int64_t>::max() / 1000) return time;
  }
  return 0;
}

/// A message: when its measurement was, and where it begins.
struct Message {
  std::int64_t time = 0;  ///< ns
  std::int64_t at = 0;    ///< bytes from the file's beginning
};

struct Channel {
  RobotMessage kind = RobotMessage::other;
  std::size_t count = 0;
  std::vector<Message> messages;  ///< none of `other`
};

using Channels = std::map<std::string, Channel>;

Channels survey(const Log& log) {
  Channels channels;
  for (;;) {
    const std::int64_t at = log.position();
    const Event event = log.next();
    if (!event) return channels;
    Channel& channel = channels[event->channel];
    const RobotMessage kind = kind_of_message(bytes_of(event));
    if (channel.count++ == 0) channel.kind = kind;
    if (kind == RobotMessage::other || kind != channel.kind) continue;
    channel.messages.push_back({1000 * time_of(event), at});
  }
}

const char* words(RobotMessage kind) {
  return kind == RobotMessage::picture ? "pictures"
         : kind == RobotMessage::cloud ? "clouds"
                                       : "of a type that is not read";
}

std::string list_of(const Channels& channels) {
  std::string list;
  for (const auto& [name, channel] : channels) {
    list += (list.empty() ? "" : ", ") + name + " (" + std::to_string(channel.count) + " " +
            words(channel.kind) + ")";
  }
  return "the log has: " + list;
}

bool same_letters(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// The sensor's channel; nullptr where it cannot be told.
const Channel* channel_of(const Channels& channels, const std::string& sensor, RobotMessage kind,
                          bool only_one) {
  const Channel* found = nullptr;
  std::size_t candidates = 0;
  for (const auto& [name, channel] : channels) {
    if (channel.kind != kind) continue;
    if (same_letters(name, sensor)) return &channel;
    found = &channel;
    ++candidates;
  }
  return only_one && candidates == 1 ? found : nullptr;
}

}  // namespace

Result<LogPlan> plan_log(const fs::path& file, const Rig& rig,
                         const std::map<std::string, std::string>& named, double tolerance) {
  const Log log(file);
  if (!log.open()) return fail(ErrorCode::io, file.string(), "cannot be read");
  const Channels channels = survey(log);
  if (channels.empty()) {
    return fail(ErrorCode::data, file.string(), "is no LCM log, or an empty one",
                "give a folder of pictures and clouds, or what lcm-logger wrote");
  }
  std::vector<Problem> problems;
  std::vector<SensorKeys> keys;
  std::map<std::string, std::vector<Message>> messages;
  const auto collect = [&](const std::string& sensor, RobotMessage kind, bool only_one) {
    const auto asked = named.find(sensor);
    const Channel* channel = nullptr;
    if (asked == named.end()) {
      channel = channel_of(channels, sensor, kind, only_one);
      if (!channel) {
        problems.push_back(
            {file.string(),
             "no channel with " + std::string(words(kind)) + " can be told to be that of '" + sensor + "'",
             "say --channel " + sensor + "=CHANNEL; " + list_of(channels)});
        return;
      }
    } else if (const auto at = channels.find(asked->second);
               at == channels.end() || at->second.kind != kind) {
      problems.push_back({file.string(),
                          "channel '" + asked->second + "' has no " + words(kind) + " for '" + sensor + "'",
                          list_of(channels)});
      return;
    } else {
      channel = &at->second;
    }
    std::vector<Message>& own = messages[sensor] = channel->messages;
    std::stable_sort(own.begin(), own.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    keys.push_back({sensor, {}});
    for (const Message& message : own) keys.back().second.push_back(message.time);
  };
  for (const auto& [name, camera] : rig.cameras)
    collect(name, RobotMessage::picture, rig.cameras.size() == 1);
  for (const auto& [name, lidar] : rig.lidars) collect(name, RobotMessage::cloud, rig.lidars.size() == 1);
  for (const auto& [sensor, channel] : named) {
    if (!rig.cameras.count(sensor) && !rig.lidars.count(sensor))
      problems.push_back({"--channel " + sensor + "=" + channel, "the rig has no sensor of this name", {}});
  }
  if (!problems.empty()) return fail(ErrorCode::data, std::move(problems));

  LogPlan plan;
  const Pairing pairing = pair_nearest(keys, static_cast<std::int64_t>(std::llround(tolerance * 1e9)));
  plan.single = pairing.single;
  for (const auto& group : pairing.groups) {
    LogGroup& out = plan.groups.emplace_back();
    for (const auto& [sensor, index] : group) out[sensor] = messages[sensor][index].at;
  }
  return plan;
}

Result<void> load_log_view(const fs::path& file, const LogGroup& group, const Rig& rig,
                           std::map<std::string, Image>& images, std::map<std::string, Scan>& scans) {
  const Log log(file);
  if (!log.open()) return fail(ErrorCode::io, file.string(), "cannot be read");
  for (const auto& [sensor, at] : group) {
    const std::string name = file.string() + ": '" + sensor + "' at byte " + std::to_string(at);
    if (!log.go_to(at)) return fail(ErrorCode::io, name, "cannot be read");
    const Event event = log.next();
    if (!event) return fail(ErrorCode::io, name, "cannot be read again");
    if (rig.cameras.count(sensor)) {
      Result<Image> image = decode_picture_message(bytes_of(event), name);
      if (!image) return fail(image.error());
      images[sensor] = std::move(*image);
    } else {
      Result<Scan> scan = decode_cloud_message(bytes_of(event), name);
      if (!scan) return fail(scan.error());
      scans[sensor] = std::move(*scan);
    }
  }
  return {};
}

}  // namespace ca2
