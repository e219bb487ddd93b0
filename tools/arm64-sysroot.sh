#!/usr/bin/env bash
# Makes a sysroot for cross builds: Debian 12's arm64 libraries and headers, unpacked, nothing of it run.
# Usage: tools/arm64-sysroot.sh DIR   (needs mmdebstrap; some 2 GB)
set -euo pipefail
directory=${1:?usage: tools/arm64-sysroot.sh DIR}
command -v mmdebstrap >/dev/null || { echo "arm64-sysroot: install mmdebstrap" >&2; exit 69; }
here=$(cd "$(dirname "$0")" && pwd)
# The libraries that the build needs, as install-packages.sh lists them: whatever is a development package.
packages=$(sed -n '/^packages=(/,/^)/p' "$here/install-packages.sh" | grep -v '^ *#' | tr ' ' '\n' | grep -E '^(lib|nlohmann)[a-z0-9.+-]*-dev$' | paste -sd,)
mmdebstrap --architectures=arm64 --variant=extract --include="$packages,libc6-dev,libstdc++-12-dev" bookworm "$directory"
# Absolute links lead out of the sysroot: made relative to it.
find "$directory" -type l -lname '/*' | while read -r link; do
  ln -snf "$(realpath -ms --relative-to="$(dirname "$link")" "$directory$(readlink "$link")")" "$link"
done
