#!/usr/bin/env bash
# Runs every command of docs/getting-started.md as it stands, in an empty directory, with the program given (or the ca2 of
# the PATH), and checks what the newcomer was promised. Usage: getting_started_test.sh [PROGRAM SCENARIOS_DIRECTORY]
set -euo pipefail
manual=$(cd "$(dirname "$0")/../../docs" && pwd)/getting-started.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ $# -ge 1 ]; then
  mkdir "$work/bin"
  ln -s "$(realpath "$1")" "$work/bin/ca2"
  PATH=$work/bin:$PATH
fi
grep -q '{.*charuco.*}' <<<"$(ca2 board --help)" || { echo "this ca2 was built without the manual's board"; exit 77; }
# The blocks marked sh; before it is installed the scenarios are in the tree.
sed -n '/^```sh$/,/^```$/p' "$manual" | grep -v '^```' | sed "s#/usr/share/ca2/scenarios#$(realpath "${2:-/usr/share/ca2/scenarios}")#" >"$work/commands"
[ "$(wc -l <"$work/commands")" -ge 8 ]
mkdir "$work/empty"
cd "$work/empty"
bash -euxo pipefail ../commands >../output
grep -q 'verdict: good' ../output
grep -q 'ros2 run tf2_ros static_transform_publisher --x' ../output
# The answer is what the simulator knows to be true: within 10 mm and 5 mrad.
grep 'true error' ../output | awk '{ if ($5 > 10 || $7 > 5) { print "too far off: " $0; exit 1 } n++ } END { exit n == 0 }'
for file in board.pdf board.yaml my-robot/report/index.html my-robot/calibration.urdf my-robot/camera_info/*.yaml; do
  [ -s "$file" ] || { echo "missing: $file"; exit 1; }
done
