#!/usr/bin/env bash
# Installs the packages in a bare Debian 12 that is thrown away afterwards, and uses them as a newcomer would:
# in_clean_root.sh tells what. Needs root, mmdebstrap and the Debian archive. Usage: clean_root.sh DIRECTORY_WITH_DEBS
# CA2_CLEAN_ROOT_DEV=1: also the development files with all that they need (1.5 GB), and a program built with them.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
debs=$(realpath "${1:?usage: clean_root.sh DIRECTORY}")
[ "$(id -u)" = 0 ] || { echo "clean_root: needs root" >&2; exit 77; }
command -v mmdebstrap >/dev/null || { echo "clean_root: install mmdebstrap" >&2; exit 69; }
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
mkdir -p "$stage/trial/tests/packaging" "$stage/trial/docs" "$stage/trial/debs"
cp -r "$here"/{in_clean_root.sh,getting_started_test.sh,overview_test.sh,consumer_test.sh,consumer} \
  "$stage/trial/tests/packaging/"
cp "$here/../../docs/getting-started.md" "$stage/trial/docs/"
cp "$debs"/*.deb "$stage/trial/debs/"
# apt's own user reads the packages.
chmod -R a+rX "$stage"
mmdebstrap --quiet --mode=root --variant=minbase --format=null \
  --customize-hook="copy-in $stage/trial /opt" \
  --customize-hook="CA2_CLEAN_ROOT_DEV=${CA2_CLEAN_ROOT_DEV:-} chroot \"\$1\" /opt/trial/tests/packaging/in_clean_root.sh /opt/trial/debs" \
  bookworm /dev/null
