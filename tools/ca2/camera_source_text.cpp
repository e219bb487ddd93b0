#include "tools/ca2/camera_source_text.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace ca2 {

Result<SourceOptions> parse_camera_source(const std::string& text) {
  const std::size_t colon = text.find(':');
  SourceOptions source{{"driver", text.substr(0, colon)}};
  for (std::size_t begin = colon == std::string::npos ? text.size() : colon + 1; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      return fail(
          ErrorCode::usage, text, "'" + word + "' is no option",
          "cameras are written driver:name=value,name=value; `ca2 sensors` prints those that are there");
    }
    if (!source.emplace(word.substr(0, equals), word.substr(equals + 1)).second) {
      return fail(ErrorCode::usage, text, "'" + word.substr(0, equals) + "' is given twice");
    }
  }
  return source;
}

std::string camera_source_text(const SourceOptions& source) {
  std::string text;
  for (const auto& [name, value] : source) {
    if (name == "driver") continue;
    text += (text.empty() ? ":" : ",") + name + "=" + value;
  }
  const auto driver = source.find("driver");
  return (driver == source.end() ? "" : driver->second) + text;
}

std::string camera_drivers_help() {
  std::string text = "Cameras are written driver:option=value,option=value. Drivers and their options:\n";
  for (const CameraDriver* driver : camera_drivers()) {
    text += "  " + std::string(driver->name) + ": " + std::string(driver->what) + "\n";
    for (const CameraOption& option : driver->options) {
      text += "    " + std::string(option.name) + ": " + std::string(option.what) + "\n";
    }
  }
  return text;
}

nlohmann::json cameras_json(const CameraListing& listing, bool controls) {
  nlohmann::json list = nlohmann::json::array();
  for (const FoundCamera& found : listing.cameras) {
    nlohmann::json entry = {{"driver", found.driver},
                            {"id", found.id},
                            {"description", found.description},
                            {"source", found.source},
                            {"problem", found.problem}};
    if (controls && found.problem.empty()) {
      const auto camera = open_camera(found.source);
      if (!camera) {
        entry["problem"] = camera.error().text();
      } else {
        entry["describes_itself_as"] = (*camera)->description();
        for (const CameraStream& stream : (*camera)->streams()) {
          entry["streams"].push_back({{"imager", stream.name},
                                      {"width", stream.width},
                                      {"height", stream.height},
                                      {"format", stream.format}});
        }
        entry["controls"] = nlohmann::json::object();
        for (const auto& [name, control] : (*camera)->controls()) {
          entry["controls"][name] = {{"value", control.value}, {"limits", control.limits}};
        }
      }
    }
    list.push_back(std::move(entry));
  }
  return list;
}

void print_cameras(const nlohmann::json& cameras) {
  for (const nlohmann::json& camera : cameras) {
    std::printf("%s\n    %s\n", camera_source_text(camera["source"].get<SourceOptions>()).c_str(),
                camera["description"].get<std::string>().c_str());
    if (const std::string problem = camera["problem"]; !problem.empty())
      std::printf("    %s\n", problem.c_str());
    for (const nlohmann::json& stream : camera.value("streams", nlohmann::json::array())) {
      std::printf("    %s%s%d x %d %s\n", stream["imager"].get<std::string>().c_str(),
                  stream["imager"].get<std::string>().empty() ? "" : ": ", stream["width"].get<int>(),
                  stream["height"].get<int>(), stream["format"].get<std::string>().c_str());
    }
    const nlohmann::json controls = camera.value("controls", nlohmann::json::object());
    for (const auto& [name, control] : controls.items()) {
      std::printf("    %s: %s (%s)\n", name.c_str(), control["value"].get<std::string>().c_str(),
                  control["limits"].get<std::string>().c_str());
    }
  }
}

}  // namespace ca2
