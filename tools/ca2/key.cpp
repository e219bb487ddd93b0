/// @file `ca2 key new`: who may command a daemon over LCM.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "messages/signing.h"
#include "tools/ca2/command.h"

namespace ca2 {

CommandBody setup_key(CLI::App& app) {
  app.require_subcommand(1);
  CLI::App* made = app.add_subcommand("new", "Makes a key that a daemon and a handheld share");
  auto file = std::make_shared<std::string>();
  made->add_option("file", *file, "SENDER.key, new; the name is that of who commands")->required();
  app.footer(
      "Copy it to the daemon's control.keys (/etc/ca2/keys), readable by its group, and to the handheld; "
      "then\n"
      "restart the daemon. `ca2 capture --key SENDER.key --host ROBOT` commands with it. See "
      "docs/security.md.");
  return [file]() -> Result<int> {
    const Result<NamedKey> key = make_key(*file);
    if (!key) return fail(key.error());
    std::printf("key of '%s' in %s\n", key->sender.c_str(), file->c_str());
    return 0;
  };
}

}  // namespace ca2
