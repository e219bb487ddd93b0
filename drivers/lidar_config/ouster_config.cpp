#include "drivers/lidar_config/ouster_config.h"

#include <netdb.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/net/udp_socket.h"

namespace ca2 {
namespace {

using nlohmann::json;

/// 7502 and [0, 1] are JSON as they stand, 1024x10 and RNG19_RFL8_SIG16_NIR16 are strings.
json value_from(const std::string& text) {
  json value = json::parse(text, nullptr, false);
  return value.is_discarded() ? json(text) : value;
}

std::string text_of(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Older firmware has some settings under another name.
Setting translated(const Setting& wanted, const json& active) {
  if (active.contains(wanted.key)) return wanted;
  if (wanted.key == "udp_dest" && active.contains("udp_ip")) return {"udp_ip", wanted.value};
  if (wanted.key == "operating_mode" && active.contains("auto_start_flag")) {
    return {"auto_start_flag", wanted.value == "NORMAL" ? "1" : "0"};
  }
  return wanted;
}

}  // namespace

Result<std::string> own_address_towards(const std::string& host) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), "9", &hints, &found);
  if (code != 0) return fail(ErrorCode::unavailable, host, gai_strerror(code));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, &freeaddrinfo);
  const UniqueFd fd(::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_storage own{};
  socklen_t length = sizeof own;
  // Connecting a datagram socket sends nothing: it only chooses the route.
  if (!fd.valid() || ::connect(fd.get(), found->ai_addr, found->ai_addrlen) != 0 ||
      ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&own), &length) != 0) {
    return fail(ErrorCode::unavailable, host, std::strerror(errno));
  }
  return address_of(own).text();
}

Result<OusterConfig> OusterConfig::connect(const std::string& host, const OusterConfigOptions& options) {
  const HttpClient http(host, options.http);
  const auto make = [&](std::unique_ptr<OusterApi> api) {
    return OusterConfig(host, options, std::move(api));
  };
  auto config = make_ouster_http_api(http, false);
  Result<std::string> answer = config->active_config();
  if (answer) return make(std::move(config));
  const bool http_answers = answer.error().code != ErrorCode::unavailable;
  if (http_answers) {
    auto commands = make_ouster_http_api(http, true);
    if (commands->active_config()) return make(std::move(commands));
  }
  auto tcp = make_ouster_tcp_api(LineClient(host, options.tcp));
  const Result<std::string> tcp_answer = tcp->active_config();
  if (tcp_answer) return make(std::move(tcp));
  Error error = std::move(answer.error());
  error.problems.insert(error.problems.end(), tcp_answer.error().problems.begin(),
                        tcp_answer.error().problems.end());
  return fail(std::move(error));
}

Result<std::string> OusterConfig::status() const {
  const Result<std::string> info = api_->sensor_info();
  if (!info) return fail(info.error());
  const json sections = json::parse(*info);
  const auto found = sections.find("status");
  if (found == sections.end() || !found->is_string()) {
    return fail(ErrorCode::data, host_, "sensor_info has no status");
  }
  return found->get<std::string>();
}

Result<std::vector<SettingChange>> OusterConfig::plan(const std::vector<Setting>& wanted) const {
  const Result<std::string> config = api_->active_config();
  if (!config) return fail(config.error());
  const json active = json::parse(*config);
  std::vector<SettingChange> changes;
  std::vector<Problem> problems;
  for (const Setting& given : wanted) {
    Setting setting = translated(given, active);
    const auto has = active.find(setting.key);
    if (has == active.end()) {
      problems.push_back({host_, "this firmware has no setting '" + setting.key + "'", ""});
      continue;
    }
    if (setting.value == "@auto") {
      const Result<std::string> own = own_address_towards(host_);
      if (!own) return fail(own.error());
      setting.value = *own;
    }
    // Compared as text too: some firmware has numbers as strings.
    const json value = value_from(setting.value);
    if (*has == value || text_of(*has) == text_of(value)) continue;
    changes.push_back({setting.key, text_of(*has), text_of(value)});
  }
  if (!problems.empty()) return fail(ErrorCode::config, std::move(problems));
  return changes;
}

Result<void> OusterConfig::apply(const std::vector<SettingChange>& changes, bool persist) const {
  if (changes.empty()) return {};
  json config = json::object();
  for (const SettingChange& change : changes) config[change.key] = value_from(change.to);
  return api_->apply(config.dump(-1, ' ', false, json::error_handler_t::replace), persist);
}

Result<void> OusterConfig::wait_until_running(std::chrono::milliseconds limit) const {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  std::string last = "nothing";
  for (;;) {
    // While it reinitialises the sensor may not answer at all.
    if (const Result<std::string> now = status()) {
      if (*now == "RUNNING") return {};
      if (*now == "ERROR") {
        return fail(ErrorCode::unavailable, host_, "the sensor's status is ERROR",
                    "its web page shows the alerts");
      }
      last = *now;
    }
    if (std::chrono::steady_clock::now() >= deadline) break;
    std::this_thread::sleep_for(options_.poll);
  }
  return fail(
      ErrorCode::unavailable, host_,
      "not running after " + std::to_string(limit.count() / 1000) + " s; its last status was " + last);
}

}  // namespace ca2
