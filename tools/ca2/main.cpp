/// @file The command-line tool: one subcommand per file, registered in commands.def.
#include "tools/ca2/command.h"

int main(int argc, char** argv) {
  return ca2::run_command_line(argc, argv);
}
