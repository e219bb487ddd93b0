#include "daemon/config/config.h"

#include <algorithm>
#include <map>

#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/io/yaml_text.h"
#include "core/types/text.h"
#include "daemon/config/check_sources.h"

namespace ca2 {
namespace {

/// Calls `visit(section, key, kind, value, least, most, restart, meaning)` for every line of the table.
template <class Options, class Visitor>
void for_each_option(Options& options, Visitor&& visit) {
#define CA2_OPTION(section, key, kind, member, least, most, restart, meaning)                           \
  visit(#section, #key, options.member, static_cast<double>(least), static_cast<double>(most), restart, \
        meaning);
#include "daemon/config/options.def"
#undef CA2_OPTION
}

const std::map<std::string, std::vector<std::string_view>>& keys_by_section() {
  static const auto table = [] {
    std::map<std::string, std::vector<std::string_view>> keys;
    const DaemonOptions any;
    for_each_option(any, [&](const char* section, const char* key, const auto&, double, double, bool,
                             const char*) { keys[section].push_back(key); });
    return keys;
  }();
  return table;
}

void read(YamlReader& reader, const YamlNode* node, double, double, std::string& value) {
  if (const auto text = reader.text(node)) value = *text;
}
void read(YamlReader& reader, const YamlNode* node, double, double, bool& value) {
  if (const auto flag = reader.boolean(node)) value = *flag;
}
void read(YamlReader& reader, const YamlNode* node, double least, double most, double& value) {
  if (const auto number = reader.number(node, least, most)) value = *number;
}
template <class Integer>
void read(YamlReader& reader, const YamlNode* node, double least, double most, Integer& value) {
  const auto number = reader.integer(node, static_cast<long long>(least), static_cast<long long>(most));
  if (number) value = static_cast<Integer>(*number);
}

std::string text_of(const std::string& value) {
  return yaml_string(value);
}
std::string text_of(bool value) {
  return value ? "true" : "false";
}
std::string text_of(double value) {
  return formatted("%.9g", value);
}
std::string text_of(long long value) {
  return std::to_string(value);
}
std::string text_of(int value) {
  return std::to_string(value);
}

/// The sections that are the daemon's; parse_rig has judged all other top-level keys.
DaemonOptions read_options(YamlReader& reader, const YamlNode& root) {
  DaemonOptions options;
  for (const auto& [section, keys] : keys_by_section()) {
    if (const YamlNode* node = root.find(section)) reader.map(node, section, keys);
  }
  for_each_option(options, [&](const char* section, const char* key, auto& value, double least, double most,
                               bool, const char*) {
    const YamlNode* node = root.find(section);
    if (node && node->is_map()) read(reader, node->find(key), least, most, value);
  });
  // select() of LCM's TCP client aborts the program, and a log played back as sensors' status makes no sense.
  const std::string& url = options.lcm_url;
  if (const YamlNode* lcm = root.find("lcm"); lcm && lcm->find("url") && !url.starts_with("udpm://")) {
    reader.problem(*lcm->find("url"), "the provider must be udpm",
                   "udpm://239.255.76.67:7667?ttl=0 keeps to this host, ttl=1 reaches the local network");
  }
  return options;
}

}  // namespace

Result<Config> parse_config(const std::string& text, const std::filesystem::path& file) {
  std::vector<std::string> sections;
  for (const auto& [section, keys] : keys_by_section()) sections.push_back(section);
  const Result<YamlNode> root = parse_yaml(text, file.string());
  if (!root) return fail(root.error());

  std::vector<Problem> problems;
  const auto note = [&](const std::vector<Problem>& more) {
    problems.insert(problems.end(), more.begin(), more.end());
  };
  Result<Rig> rig = parse_rig(text, file, sections);
  if (!rig) note(rig.error().problems);
  YamlReader reader(file.string());
  DaemonOptions options = read_options(reader, *root);
  note(reader.problems());
  if (rig) note(check_sources(*rig, file));
  if (!problems.empty()) return fail(ErrorCode::config, std::move(problems));
  return Config{file, std::move(*rig), std::move(options)};
}

Result<Config> read_config(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  return parse_config(*text, file);
}

std::string write_config(const Config& config) {
  std::string out = "# " + config.file.string() + " as ca2d understands it\n" + write_rig(config.rig);
  std::string open;
  for_each_option(config.options, [&](const char* section, const char* key, const auto& value, double, double,
                                      bool restart, const char* meaning) {
    if (open != section) out += (open = section) + ":\n";
    out += formatted("  %-35s # %s%s\n", (std::string(key) + ": " + text_of(value)).c_str(), meaning,
                     restart ? " (restart)" : "");
  });
  return out;
}

std::vector<std::string> needs_restart(const DaemonOptions& before, const DaemonOptions& after) {
  std::map<std::string, std::string> values;
  for_each_option(before, [&](const char* section, const char* key, const auto& value, double, double,
                              bool restart, const char*) {
    if (restart) values[std::string(section) + "." + key] = text_of(value);
  });
  std::vector<std::string> names;
  for_each_option(after, [&](const char* section, const char* key, const auto& value, double, double,
                             bool restart, const char*) {
    const std::string name = std::string(section) + "." + key;
    if (restart && values[name] != text_of(value)) names.push_back(name);
  });
  return names;
}

}  // namespace ca2
