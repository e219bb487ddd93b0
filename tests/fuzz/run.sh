#!/usr/bin/env bash
# Fuzzes every target for some seconds, from what is kept in corpus/: ./tests/fuzz/run.sh [SECONDS] [TARGET...]
# What it finds stays in build/fuzz/corpus; a finding ends the run and is named.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-60}
shift || true
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  for source in tests/fuzz/fuzz_*.cpp; do targets+=("$(basename "$source" .cpp)"); done
fi
cmake --preset fuzz -G Ninja >/dev/null
cmake --build --preset fuzz --target "${targets[@]}"
for target in "${targets[@]}"; do
  found=build/fuzz/corpus/$target
  mkdir -p "$found"
  kept=tests/fuzz/corpus/$target
  directories=("$found")
  if [ -d "$kept" ]; then directories+=("$kept"); fi
  # Small inputs: they reach the same code and are many times quicker.
  "build/fuzz/bin/$target" -max_total_time="$seconds" -max_len=2048 -timeout=20 -verbosity=0 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/$target-" "${directories[@]}"
done
