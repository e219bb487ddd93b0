/// `ca2 bench NAME`: runs one of the benchmarks of benches.def.
#include "tools/ca2/bench.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "tools/ca2/command.h"
#include "tools/ca2/number_in.h"

namespace ca2 {

#define CA2_BENCH(name, what) Result<int> bench_##name(const BenchOptions& options);
#include "tools/ca2/benches.def"
#undef CA2_BENCH

namespace {

struct Bench {
  const char* name;
  const char* what;
  Result<int> (*run)(const BenchOptions&);
};

const std::vector<Bench>& benches() {
  static const std::vector<Bench> list{
#define CA2_BENCH(name, what) {#name, what, bench_##name},
#include "tools/ca2/benches.def"
#undef CA2_BENCH
  };
  return list;
}

}  // namespace

CommandBody setup_bench(CLI::App& app) {
  struct Options {
    std::string name;
    BenchOptions bench;
  };
  const auto options = std::make_shared<Options>();
  std::vector<std::string> names;
  std::string footer = "Benchmarks:\n";
  for (const Bench& bench : benches()) {
    names.emplace_back(bench.name);
    footer += "  " + std::string(bench.name) + "  " + bench.what + "\n";
  }
  app.footer(footer);
  app.add_option("name", options->name, "Which benchmark")->required()->check(CLI::IsMember(names));
  app.add_option("--data", options->bench.data,
                 "Directory to measure on: with scenarios (without it config/scenarios here, or those "
                 "installed), a session, recordings");
  app.add_option("--repeats", options->bench.repeats,
                 "How often each measurement is made (the median counts)")
      ->check(number_in(1, 1000));
  app.add_option("--seconds", options->bench.seconds, "ingest: how long each load at a steady rate lasts")
      ->check(number_in(0.1, 3600));
  app.add_option("--seed", options->bench.seed,
                 "accuracy, stereo, guidance: the seed of everything that is drawn")
      ->type_name("N");
  app.add_option("--trials", options->bench.trials,
                 "accuracy, stereo: trials per cell (12, with --full 100); guidance: seeds (21)")
      ->check(number_in(1, 100000));
  app.add_flag("--full", options->bench.full,
               "accuracy, stereo: 100 trials; accuracy: every number of views");
  app.add_option(
      "--only", options->bench.only,
      "accuracy, stereo, solve, decode, detect, track, guidance: only what has this text in its name");
  app.add_option("--plot", options->bench.plot, "accuracy: write the errors as an SVG plot to this file");
  app.add_flag("--json", options->bench.json, "Print the table as JSON");
  return [options]() -> Result<int> {
    for (const Bench& bench : benches()) {
      if (options->name == bench.name) return bench.run(options->bench);
    }
    return fail(ErrorCode::usage, "", "no benchmark '" + options->name + "'", "see `ca2 bench --help`");
  };
}

}  // namespace ca2
