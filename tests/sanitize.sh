#!/usr/bin/env bash
# Builds the programs with a sanitizer and runs every system test on them: ./tests/sanitize.sh tsan, ./tests/sanitize.sh asan
# (addresses, leaks, undefined behaviour, float to integer). More arguments go to ctest: ./tests/sanitize.sh tsan -R 060
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-}
[ "$preset" = tsan ] || [ "$preset" = asan ] || { echo "usage: $0 tsan|asan [ctest's arguments]" >&2; exit 64; }
shift
./tools/install-packages.sh
cmake --preset "$preset" -G Ninja
cmake --build --preset "$preset" --target system_test_programs
ctest --preset "$preset" -L system "$@"
