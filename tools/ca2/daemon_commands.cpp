/// @file `ca2 session`, `capture`, `auto`, `pick`, `views`, `drop`: short commands to the daemon.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/types/counted.h"
#include "core/types/text.h"
#include "tools/ca2/command.h"
#include "tools/ca2/daemon_link.h"
#include "tools/ca2/number_in.h"

namespace ca2 {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

// Storing a view takes a second on a slow disk; opening a large session without its cache, longer.
constexpr milliseconds short_time{10'000}, long_time{120'000};

struct Short {
  DaemonAddress address;
  bool as_json = false;
  json arguments = json::object();
};

std::shared_ptr<Short> add_options(CLI::App& app) {
  auto options = std::make_shared<Short>();
  add_daemon_options(app, options->address);
  app.add_flag("--json", options->as_json, "For programs");
  return options;
}

/// Calls, and prints the answer as JSON or as `text` says it.
Result<int> call(const Short& options, const std::string& command, milliseconds timeout,
                 const std::function<std::string(const json&)>& text) {
  const Result<json> reply = call_daemon(options.address, command, options.arguments, timeout);
  if (!reply) return fail(reply.error());
  try {
    std::printf("%s\n", options.as_json ? reply->dump(2).c_str() : text(*reply).c_str());
  } catch (const json::exception& error) {
    return fail(ErrorCode::data, "", std::string("the daemon's answer is not understood: ") + error.what(),
                "are the daemon and this program of the same version?");
  }
  return 0;
}

std::string text_of(const json& reply) {
  return reply.at("text");
}

std::string session_line(const json& session) {
  const std::string problem = session.at("problem");
  return formatted("%c %-24s %9s%s%s", session.at("current").get<bool>() ? '*' : ' ',
                   session.at("name").get<std::string>().c_str(),
                   counted(session.at("views").get<int>(), "view").c_str(),
                   session.at("solved").get<bool>() ? ", solved" : "",
                   !problem.empty()                  ? ("  " + problem).c_str()
                   : !session.at("fits").get<bool>() ? "  of another rig"
                                                     : "");
}

std::string view_line(const json& view) {
  std::string out = formatted("view %d", view.at("id").get<int>());
  if (view.at("used").is_null()) return out + ": not solved yet";
  if (!view.at("used").get<bool>()) return out + ": not used: " + view.at("reason").get<std::string>();
  if (!view.at("reprojection_rms").is_null())
    out += formatted(": reprojection %.3f px", view.at("reprojection_rms").get<double>());
  if (!view.at("plane_rms").is_null())
    out += formatted(", plane %.1f mm", 1e3 * view.at("plane_rms").get<double>());
  return out;
}

/// One line per entry of a list.
std::string lines(const json& list, const std::function<std::string(const json&)>& line,
                  const std::string& none) {
  std::string out;
  for (const json& entry : list) out += (out.empty() ? "" : "\n") + line(entry);
  return out.empty() ? none : out;
}

}  // namespace

CommandBody setup_session(CLI::App& app) {
  app.require_subcommand(1);
  auto body = std::make_shared<CommandBody>();
  const auto opened = [](const json& reply) { return "session " + reply.at("session").get<std::string>(); };
  const auto add = [&](const char* name, const char* help, const char* command, bool named, bool required) {
    CLI::App* sub = app.add_subcommand(name, help);
    const auto options = add_options(*sub);
    if (named) {
      sub->add_option_function<std::string>(
             "name", [options](const std::string& text) { options->arguments["name"] = text; }, "Its name")
          ->required(required);
    }
    sub->callback([body, options, command, opened] {
      *body = [options, command, opened] { return call(*options, command, long_time, opened); };
    });
  };
  add("new", "Begin a session", "session_new", true, false);
  add("use", "Go on with a session", "session_use", true, true);
  add("resume", "Go on with the one used before this", "session_resume", false, false);
  CLI::App* list = app.add_subcommand("list", "The daemon's sessions, the newest first");
  const auto options = add_options(*list);
  list->callback([body, options] {
    *body = [options] {
      return call(*options, "session_list", long_time, [](const json& reply) {
        return lines(reply.at("sessions"), session_line, "there are no sessions");
      });
    };
  });
  return [body] { return (*body)(); };
}

CommandBody setup_capture(CLI::App& app) {
  const auto options = add_options(app);
  auto now = std::make_shared<bool>(false);
  app.add_flag("--now", *now, "Take what is there, without waiting for stillness");
  return [options, now] {
    options->arguments["now"] = *now;
    return call(*options, "capture", short_time, [](const json& reply) -> std::string {
      if (reply.at("view").is_null()) return "hold the board still: it is captured then";
      return formatted("view %d is stored", reply.at("view").get<int>());
    });
  };
}

CommandBody setup_auto(CLI::App& app) {
  const auto options = add_options(app);
  auto word = std::make_shared<std::string>();
  app.add_option("state", *word, "on or off")->required()->check(CLI::IsMember({"on", "off"}));
  return [options, word] {
    options->arguments["on"] = *word == "on";
    return call(*options, "auto", short_time, text_of);
  };
}

CommandBody setup_pick(CLI::App& app) {
  const auto options = add_options(app);
  auto lidar = std::make_shared<std::string>();
  auto place = std::make_shared<std::tuple<int, int, double>>(0, 0, 0);
  app.add_option("lidar", *lidar, "Its name in the rig")->required();
  app.add_option("row", std::get<0>(*place), "Ring")->required()->check(number_in(0, 1000));
  app.add_option("column", std::get<1>(*place), "Column of the projection by ID")
      ->required()
      ->check(number_in(0, 100000));
  app.add_option("radius", std::get<2>(*place), "px; default: what the board's size makes")
      ->check(number_in(0, 1000));
  return [options, lidar, place] {
    options->arguments = {{"lidar", *lidar},
                          {"row", std::get<0>(*place)},
                          {"column", std::get<1>(*place)},
                          {"radius", std::get<2>(*place)}};
    return call(*options, "pick", short_time, text_of);
  };
}

CommandBody setup_views(CLI::App& app) {
  const auto options = add_options(app);
  return [options] {
    return call(*options, "views", short_time,
                [](const json& reply) { return lines(reply.at("views"), view_line, "there are no views"); });
  };
}

CommandBody setup_drop(CLI::App& app) {
  const auto options = add_options(app);
  auto view = std::make_shared<int>(0);
  app.add_option("view", *view, "Its number (`ca2 views`)")->required()->check(number_in(0, 1000000000));
  return [options, view] {
    options->arguments["view"] = *view;
    return call(*options, "drop", short_time, text_of);
  };
}

}  // namespace ca2
