#!/usr/bin/env bash
# The main job without hardware: simulates a rig, calibrates it, prints the answer with its sigma and its true error,
# and leaves a picture and a report to open. Usage: ./tools/demo.sh [SCENARIO.yaml]   (see config/scenarios)
set -euo pipefail
cd "$(dirname "$0")/.."
scenario=${1:-config/scenarios/paper.yaml}
name=$(basename "$scenario" .yaml)
output=demo/$name

./tools/install-packages.sh
echo "building (the first time takes some minutes) ..."
cmake --preset release -G Ninja >/dev/null
cmake --build --preset release --target ca2
ca2=build/release/bin/ca2

rm -rf "$output"
echo "simulating $scenario ..."
"$ca2" simulate "$scenario" --output "$output" --session
echo "calibrating $output ..."
"$ca2" solve "$output"
"$ca2" report "$output" >/dev/null
echo
echo "the points on a picture: $output/report/overlay.png"
echo "the report:              $output/report/index.html"
