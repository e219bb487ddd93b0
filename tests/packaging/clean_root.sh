#!/usr/bin/env bash
# Installs the packages in a bare Debian 12 that is thrown away afterwards, and uses them as a newcomer would:
# in_clean_root.sh tells what. Needs root, mmdebstrap and the Debian archive. Usage: clean_root.sh DIRECTORY_WITH_DEBS
# CA2_CLEAN_ROOT_DEV=1: also the development files with all that they need (1.5 GB), and a program built with them.
# Exit status 77, with the reason: no bare Debian can be had here.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
debs=$(realpath "${1:?usage: clean_root.sh DIRECTORY}")
skip() { echo "clean_root: not tried: $*"; exit 77; }
[ "$(id -u)" = 0 ] || skip "needs root"
command -v mmdebstrap >/dev/null || skip "mmdebstrap is not installed (tools/install-packages.sh)"
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
mkdir -p "$stage/trial/tests/packaging" "$stage/trial/docs" "$stage/trial/debs"
cp -r "$here"/{in_clean_root.sh,getting_started_test.sh,overview_test.sh,consumer_test.sh,consumer} \
  "$stage/trial/tests/packaging/"
cp "$here/../../docs/getting-started.md" "$stage/trial/docs/"
cp "$debs"/*.deb "$stage/trial/debs/"
# apt's own user reads the packages.
chmod -R a+rX "$stage"
status=0
mmdebstrap --quiet --mode=root --variant=minbase --format=null --dpkgopt=force-unsafe-io \
  --customize-hook="touch $stage/bare" \
  --customize-hook="copy-in $stage/trial /opt" \
  --customize-hook="CA2_CLEAN_ROOT_DEV=${CA2_CLEAN_ROOT_DEV:-} chroot \"\$1\" /opt/trial/tests/packaging/in_clean_root.sh /opt/trial/debs" \
  bookworm /dev/null || status=$?
# What fails before there is a Debian says nothing of the packages.
[ -e "$stage/bare" ] || skip "mmdebstrap could not make a bare Debian (above): is there a network, may this container mount?"
exit "$status"
