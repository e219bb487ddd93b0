#!/usr/bin/env bash
# Installs what building and testing need on Debian 12, as root or through sudo; does nothing when all is there.
set -euo pipefail

packages=(
  # tools
  build-essential cmake ninja-build pkg-config ccache unzip clang-format-14
  # libraries: the README's table says what each is for
  libeigen3-dev libopencv-dev libopencv-core-dev libopencv-imgproc-dev libopencv-calib3d-dev libopencv-contrib-dev
  libpcl-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libexpected-dev libpng-dev libturbojpeg0-dev libpcap-dev libpugixml-dev
  libcpp-httplib-dev
  libusb-1.0-0-dev
  libaravis-dev
  libssl-dev
  libapriltag-dev
  libqhull-dev
  liblcm-dev liblcm-bin libsodium-dev
  libsystemd-dev libspdlog-dev libchafa-dev
  # tests
  libgtest-dev
  jq
  umockdev
  libumockdev-dev
  valgrind
  # printed boards drawn by programs of others
  librsvg2-bin
  # packages
  lintian
  mmdebstrap
  mandoc
  poppler-utils
  # tests against device interfaces: a guest machine with Debian's own kernel
  qemu-system-x86
  busybox-static
  cpio
  kmod
  udev
  iproute2
  systemd
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "install-packages: run as root, or install sudo; missing: ${missing[*]}" >&2; exit 77; }
  as_root=(sudo)
fi
echo "installing ${#missing[@]} packages: ${missing[*]}" >&2
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q >/dev/null
log=$(mktemp)
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -yq --no-install-recommends "${missing[@]}" >"$log" 2>&1 ||
  { tail -20 "$log" >&2; rm -f "$log"; echo "install-packages: apt-get failed" >&2; exit 69; }
rm -f "$log"
