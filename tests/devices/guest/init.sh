#!/bin/busybox sh
# PID 1 of the initramfs: the host's / read-only over 9p below a tmpfs overlay becomes the root.
b=/bin/busybox
$b mount -t proc proc /proc
$b mount -t sysfs sys /sys
$b mount -t devtmpfs dev /dev
for module in $($b cat /modules/order); do $b insmod /modules/$module || echo "init: insmod $module failed"; done
over_9p=trans=virtio,version=9p2000.L,msize=512000
$b mount -t 9p -o ro,$over_9p,cache=loose host /lower || { echo "init: no host root"; $b poweroff -f; }
$b mount -t tmpfs -o size=1g tmpfs /upper
$b mkdir /upper/upper /upper/work
$b mount -t overlay -o lowerdir=/lower,upperdir=/upper/upper,workdir=/upper/work,xino=off overlay /root
for directory in proc sys dev; do $b mount --move /$directory /root/$directory; done
$b mkdir -p /root/job /root/kernel
$b mount -t 9p -o rw,$over_9p,cache=none job /root/job
$b mount -t 9p -o ro,$over_9p,cache=loose kernel /root/kernel
exec $b switch_root /root /bin/sh /job/boot.sh
