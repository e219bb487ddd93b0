#!/usr/bin/env bash
# Installs what it needs, builds with warnings as errors, runs every test. Arguments go to ctest: ./tests/run.sh -R core/solve
set -euo pipefail
cd "$(dirname "$0")/.."
./tools/install-packages.sh
cmake --preset release -G Ninja -DCA2_WERROR=ON
cmake --build --preset release
ctest --preset release --parallel "$(nproc)" "$@"
