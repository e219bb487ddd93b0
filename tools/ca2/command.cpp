#include "tools/ca2/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string_view>
#include <utility>
#include <vector>

#include "ca2_version.h"
#include "core/io/yaml_reader.h"

namespace ca2 {

#define CA2_COMMAND(name, help) CommandBody setup_##name(CLI::App& app);
#include "tools/ca2/commands.def"
#undef CA2_COMMAND

namespace {

struct Command {
  const char* name;
  const char* help;
  CommandSetup setup;
};

const std::vector<Command>& commands() {
  static const std::vector<Command> list{
#define CA2_COMMAND(name, help) {#name, help, setup_##name},
#include "tools/ca2/commands.def"
#undef CA2_COMMAND
  };
  return list;
}

/// "Example:" or "Examples:" with those of examples.def at the end of the help of a command and its own.
void add_examples(CLI::App& app, const std::string& words) {
  static constexpr std::pair<std::string_view, const char*> list[]{
#define CA2_EXAMPLE(line, command) {command, line},
#include "tools/ca2/examples.def"
#undef CA2_EXAMPLE
  };
  std::string lines;
  for (const auto& [command, line] : list) {
    if (command != words) continue;
    lines += (lines.empty() ? "  " : "\n  ") + std::string(line);
  }
  if (!lines.empty()) {
    std::string before = app.get_footer();
    while (!before.empty() && before.back() == '\n') before.pop_back();
    if (!before.empty()) before += "\n\n";
    app.footer(before + (lines.find('\n') == std::string::npos ? "Example:\n" : "Examples:\n") + lines);
  }
  for (CLI::App* below : app.get_subcommands({})) {
    add_examples(*below, words.empty() ? below->get_name() : words + " " + below->get_name());
  }
}

int report(const Error& error) {
  for (const Problem& problem : error.problems) {
    std::fprintf(stderr, "ca2: %s\n",
                 Error(error.code, problem.where, problem.what, problem.hint).text().c_str());
  }
  return static_cast<int>(error.code);
}

/// What was printed may be what was asked for, in a file or a pipe: lost output is no success.
int printed(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return std::max(code,
                  report(Error(ErrorCode::io, "standard output", "writing failed", "is the disk full?")));
}

int run(int argc, char** argv) {
  CLI::App app("Calibrates LiDARs and cameras with a printed board.", "ca2");
  app.set_version_flag("--version", "ca2 " CA2_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done, 1 refused (no result written), 64 usage, 65 bad data, 69 no daemon or\n"
      "sensor, 73 cannot create, 74 I/O, 77 not permitted, 78 bad configuration. `ca2 COMMAND --help` "
      "explains a command.");
  std::vector<CommandBody> bodies;
  for (const Command& command : commands()) {
    bodies.push_back(command.setup(*app.add_subcommand(command.name, command.help)));
  }
  add_examples(app, "");
  std::vector<std::string_view> names;
  for (const Command& command : commands()) names.emplace_back(command.name);
  if (argc > 1 && argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end()) {
    return report(
        Error(ErrorCode::usage, "", std::string("no command '") + argv[1] + "'", suggest(argv[1], names)));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "ca2: %s; see `ca2 --help`\n", error.what());
    return static_cast<int>(ErrorCode::usage);
  }
  try {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!app.got_subcommand(commands()[i].name)) continue;
      const Result<int> result = bodies[i]();
      return result ? *result : report(result.error());
    }
  } catch (const std::exception& error) {
    return report(
        Error(ErrorCode::internal, "", std::string("internal error: ") + error.what(), "please report this"));
  }
  return 0;
}

}  // namespace

int run_command_line(int argc, char** argv) {
  return printed(run(argc, argv));
}

}  // namespace ca2
