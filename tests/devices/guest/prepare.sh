#!/usr/bin/env bash
# prepare.sh CACHE: makes CACHE/current, what run.sh boots: Debian's own kernel with its modules, v4l2loopback and
# raw_gadget built for it, and the initramfs. Packages are downloaded and unpacked, nothing is installed. Does nothing
# when CACHE/current is there for the kernel version that Debian's linux-image-amd64 names now.
# Exit status: 0 ready; 77 something this machine lacks; else a failure.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cache=$(mkdir -p "$1" && cd "$1" && pwd)

skip() { echo "skipped: $*" >&2; exit 77; }

lacking=()
for program in qemu-system-x86_64 busybox cpio depmod modprobe dpkg apt-get apt-cache make gcc flock; do
  PATH=$PATH:/usr/sbin:/sbin command -v $program >/dev/null || lacking+=("$program")
done
[ ${#lacking[@]} -eq 0 ] || skip "the guest machine needs ${lacking[*]}; tools/install-packages.sh installs them"
PATH=$PATH:/usr/sbin:/sbin

exec 9>"$cache/lock"
flock 9

# Debian names the kernel by version, and the version moves: derived, never written down.
image=$(apt-cache depends linux-image-amd64 2>/dev/null | sed -n 's/^ *Depends: \(linux-image-.*\)$/\1/p' | head -1)
[ -n "$image" ] || skip "apt knows no linux-image-amd64: run apt-get update"
version=${image#linux-image-}
series=$(echo "$version" | cut -d. -f1,2)
recipe=$(cat "$here/prepare.sh" "$here/init.sh" | sha256sum | cut -c1-16)
stamp="$version $recipe"
[ "$(cat "$cache/current/stamp" 2>/dev/null)" = "$stamp" ] && exit 0

work=$cache/work
rm -rf "$work"
mkdir -p "$work"/{packages,headers,kernel,raw_gadget}

# package NAME: downloads it and prints the path of its .deb. Fails when apt's lists are older than the archive.
package() {
  (cd "$work/packages" && apt-get download -q "$1" >"$work/apt.log" 2>&1) && ls "$work/packages/$1"_*.deb
}
source_package=linux-source-$series
packages=("$image" "linux-headers-$version" "linux-headers-${version%-amd64}-common" "linux-kbuild-$series" v4l2loopback-dkms)
for name in "${packages[@]}" "$source_package"; do
  package "$name" >"$work/$name.deb" ||
    { apt-get update -q >/dev/null 2>&1 && package "$name" >"$work/$name.deb"; } ||
    skip "cannot download Debian's package $name ($(tail -1 "$work/apt.log")); is there a network, was apt-get update run?"
done
deb() { cat "$work/$1.deb"; }

dpkg -x "$(deb "$image")" "$work/kernel"
for name in "${packages[@]:1}"; do dpkg -x "$(deb "$name")" "$work/headers"; done
headers=$work/headers/usr/src/linux-headers-$version
sed -i "s#/usr/src#$work/headers/usr/src#" "$headers/Makefile"

# One file of the kernel's source: Debian does not build raw_gadget. tar stops reading once it has it.
dpkg --fsys-tarfile "$(deb "$source_package")" 2>/dev/null |
  tar -xO "./usr/src/$source_package.tar.xz" 2>/dev/null |
  tar -xJO --occurrence=1 "$source_package/drivers/usb/gadget/legacy/raw_gadget.c" \
    >"$work/raw_gadget/raw_gadget.c" 2>/dev/null || true # the earlier two end by SIGPIPE
[ -s "$work/raw_gadget/raw_gadget.c" ] || { echo "raw_gadget.c is not in $source_package" >&2; exit 1; }
echo 'obj-m := raw_gadget.o' >"$work/raw_gadget/Kbuild"
cp -r "$work"/headers/usr/src/v4l2loopback-* "$work/v4l2loopback"

updates=$work/kernel/lib/modules/$version/updates
mkdir -p "$updates"
for module in v4l2loopback raw_gadget; do
  make -s -C "$headers" M="$work/$module" modules >"$work/make.log" 2>&1 ||
    { tail -20 "$work/make.log" >&2; echo "cannot build $module for $version" >&2; exit 1; }
  cp "$work/$module/$module.ko" "$updates/"
done
depmod -b "$work/kernel" "$version"

# The initramfs: busybox, what mounting the host's / needs, and init.sh.
root=$work/initramfs
mkdir -p "$root"/{bin,modules,proc,sys,dev,lower,upper,root}
cp "$(command -v busybox)" "$root/bin/busybox"
ldd "$root/bin/busybox" >/dev/null 2>&1 && skip "busybox is not static; tools/install-packages.sh installs busybox-static"
for module in virtio_pci 9pnet_virtio 9p overlay; do
  modprobe -d "$work/kernel" -S "$version" --show-depends "$module" | awk '$1 == "insmod" {print $2}'
done | awk '!seen[$0]++' | while read -r file; do
  cp "$file" "$root/modules/"
  basename "$file" >>"$root/modules/order"
done
cp "$here/init.sh" "$root/init"
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/initrd.gz"

mv "$work/kernel/boot/vmlinuz-$version" "$work/vmlinuz"
rm -rf "$work"/{packages,headers,raw_gadget,v4l2loopback,initramfs,*.deb,*.log} "$cache/current"
echo "$stamp" >"$work/stamp"
mv "$work" "$cache/current"
echo "guest kernel $version is ready in $cache/current"
