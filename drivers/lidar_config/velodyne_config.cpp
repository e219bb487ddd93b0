#include "drivers/lidar_config/velodyne_config.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "core/io/json.h"

namespace ca2 {
namespace {

using nlohmann::json;

/// Where a setting is posted, and under which name.
struct Field {
  const char* key;   ///< in the snapshot's config
  const char* path;  ///< of the form
  const char* name;  ///< in the form
};

constexpr Field fields[] = {
    {"rpm", "/cgi/setting", "rpm"},
    {"returns", "/cgi/setting", "returns"},
    {"laser", "/cgi/setting", "laser"},
    {"fov.start", "/cgi/setting/fov", "start"},
    {"fov.end", "/cgi/setting/fov", "end"},
    {"host.addr", "/cgi/setting/host", "addr"},
    {"host.dport", "/cgi/setting/host", "dport"},
    {"host.tport", "/cgi/setting/host", "tport"},
    {"phaselock.enabled", "/cgi/setting/phaselock", "enabled"},
    {"phaselock.offset", "/cgi/setting/phaselock", "offset"},
};

const Field* field_of(const std::string& key) {
  const auto found =
      std::find_if(std::begin(fields), std::end(fields), [&](const Field& f) { return key == f.key; });
  return found == std::end(fields) ? nullptr : found;
}

std::string lower(std::string text) {
  for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return text;
}

}  // namespace

Result<std::string> VelodyneConfig::read_object(const std::string& path) const {
  const Result<HttpReply> reply = client_.get(path);
  if (!reply) return fail(reply.error());
  if (!reply->ok()) {
    return fail(ErrorCode::data, client_.url(path),
                "the sensor answers HTTP " + std::to_string(reply->status), "an HDL-64E has no web pages");
  }
  if (!parse_json(reply->body).is_object()) {
    return fail(ErrorCode::data, client_.url(path), "the answer is no JSON object",
                "is this address a Velodyne's?");
  }
  return reply->body;
}

Result<std::string> VelodyneConfig::read_snapshot() const {
  return read_object("/cgi/snapshot.hdl");
}

Result<std::string> VelodyneConfig::read_info() const {
  return read_object("/cgi/info.json");
}

Result<std::vector<SettingChange>> VelodyneConfig::plan(const std::vector<Setting>& wanted) const {
  const Result<std::string> snapshot = read_snapshot();
  if (!snapshot) return fail(snapshot.error());
  const json all = json::parse(*snapshot);
  const json config = all.value("config", json::object());
  std::vector<SettingChange> changes;
  std::vector<Problem> problems;
  for (const Setting& setting : wanted) {
    if (field_of(setting.key) == nullptr) {
      std::string known;
      for (const Field& field : fields) known += std::string(known.empty() ? "" : ", ") + field.key;
      problems.push_back(
          {client_.url(""), "there is no setting '" + setting.key + "'", "there are " + known});
      continue;
    }
    std::string path = "/" + setting.key;
    std::replace(path.begin(), path.end(), '.', '/');
    const json::json_pointer pointer(path);
    // The sensor says "On" or "Strongest", the form takes "on": letter case says nothing.
    std::string has;
    if (config.is_object() && config.contains(pointer)) {
      const json& value = config[pointer];
      has = value.is_string() ? value.get<std::string>() : value.dump();
    }
    if (lower(has) != lower(setting.value)) changes.push_back({setting.key, has, setting.value});
  }
  if (!problems.empty()) return fail(ErrorCode::config, std::move(problems));
  return changes;
}

Result<void> VelodyneConfig::post(const std::string& path, const std::string& form) const {
  const Result<HttpReply> reply = client_.post(path, form, "application/x-www-form-urlencoded");
  if (!reply) return fail(reply.error());
  if (!reply->ok()) {
    return fail(ErrorCode::config, client_.url(path),
                "the sensor refuses '" + form + "' (HTTP " + std::to_string(reply->status) + ")");
  }
  return {};
}

Result<void> VelodyneConfig::apply(const std::vector<SettingChange>& changes, bool persist) const {
  for (const SettingChange& change : changes) {
    const Field* field = field_of(change.key);
    if (field == nullptr)
      return fail(ErrorCode::config, client_.url(""), "there is no setting '" + change.key + "'");
    if (auto done = post(field->path, std::string(field->name) + "=" + url_encode(change.to)); !done)
      return done;
  }
  if (persist && !changes.empty()) return post("/cgi/save", "submit");
  return {};
}

}  // namespace ca2
