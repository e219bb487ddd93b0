#include "daemon/dispatch/dispatcher.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "core/io/yaml_reader.h"
#include "daemon/dispatch/commands.h"
#include "daemon/log.h"

namespace ca2 {
namespace {

struct Command {
  std::string_view name;
  CommandHandler handler;
};

const std::vector<Command>& commands() {
  static const std::vector<Command> list{
#define CA2_DAEMON_COMMAND(name, takes, gives) {#name, answer_##name},
#include "daemon/dispatch/commands.def"
#undef CA2_DAEMON_COMMAND
  };
  return list;
}

bool changes_something(std::string_view command) {
  return command != "status" && command != "views" && command != "preview" && command != "session_list";
}

}  // namespace

void dispatch(const CommandTargets& targets, const std::string& origin, const std::string& command,
              const nlohmann::json& arguments, CommandAnswer answer) {
  std::vector<std::string_view> names;
  for (const Command& known : commands()) {
    names.push_back(known.name);
    if (known.name != command) continue;
    if (changes_something(command)) log::info("control", origin + ": " + command + " " + arguments.dump());
    return known.handler(targets, arguments, std::move(answer));
  }
  answer(fail(ErrorCode::usage, "", "there is no command '" + command.substr(0, 64) + "'",
              suggest(command, names)));
}

}  // namespace ca2
