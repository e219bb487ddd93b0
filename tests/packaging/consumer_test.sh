#!/usr/bin/env bash
# Builds tests/packaging/consumer, a program of others, against installed development files and nothing of the tree, and
# runs it on a board that `ca2 board` drew (where a ca2 is given or in the PATH).
# Usage: consumer_test.sh PREFIX [PROGRAM]            the files are installed there: /usr, or an unpacked package's usr
#        consumer_test.sh --build DIRECTORY [PROGRAM]  installs them from a build first
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "$1" = --build ]; then
  shift
  cmake --install "$1" --component libca2-dev --prefix "$work/usr" >/dev/null
  set -- "$work/usr" "${@:2}"
fi
prefix=$(realpath "$1")
program=${2:-$(command -v ca2 || true)}
cp -r "$here/consumer" "$work/consumer"
cmake -S "$work/consumer" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$prefix" >"$work/log" 2>&1 &&
  cmake --build "$work/build" >>"$work/log" 2>&1 || { tail -40 "$work/log"; exit 1; }
# None of the headers came from the tree.
if grep -rlF "$(cd "$here/../.." && pwd)/core" "$work/build" --include='*.d' --include='*.make'; then exit 1; fi
[ -n "$program" ] || { echo "consumer: built"; exit 0; }
"$program" board --type checkerboard --paper A4 --dpi 100 --output "$work/board.png" >/dev/null
{ echo 'version: 1'; cat "$work/board.yaml"; echo 'cameras: {front: {}}'; } >"$work/rig.yaml"
"$work/build/consumer" "$work/rig.yaml" "$work/board.png" >"$work/out"
cat "$work/out"
grep -q '^40 of 40 corners$' "$work/out"
grep -q 'v4l2' "$work/out"
