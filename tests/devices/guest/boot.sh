# First program in the guest's real root: mounts, modules, then the job, directly or under systemd.
. /job/settings.sh
export PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb LC_ALL=C.UTF-8
mkdir -p /lib/modules
mount --bind /kernel/lib/modules /lib/modules
mount -t tmpfs tmpfs /run
mkdir -p /dev/shm /dev/pts
mount -t tmpfs tmpfs /dev/shm
mount -t devpts devpts /dev/pts
# /tmp stays the overlay over the host's, because the tree that is tested may lie there.
mount -t cgroup2 cgroup2 /sys/fs/cgroup
hostname guest
ip link set lo up multicast on
ip route add 224.0.0.0/4 dev lo
for module in $modules; do
  modprobe "${module%%:*}" $(echo "$module" | cut -s -d: -f2- | tr , ' ') || echo "guest: modprobe $module failed"
done

if [ "$systemd" = 0 ]; then
  cd /job
  sh "$job"
  echo $? >/job/status
  sync
  poweroff -f
fi

units=/run/systemd/system
mkdir -p $units/job.target.wants
cat >$units/job.target <<UNIT
[Unit]
Requires=basic.target
After=basic.target
AllowIsolate=yes
UNIT
cat >$units/job.service <<UNIT
[Unit]
After=basic.target
[Service]
Type=oneshot
Environment=HOME=/root LC_ALL=C.UTF-8 PATH=$PATH
StandardOutput=tty
StandardError=tty
TTYPath=/dev/ttyS0
WorkingDirectory=/job
ExecStart=/bin/sh -c '. ./settings.sh; sh "\$job"; echo \$? >/job/status; sync; poweroff -ff'
UNIT
ln -s ../job.service $units/job.target.wants/
# What a machine does at boot and this one does not need: without KVM each costs a second or more.
for unit in systemd-timesyncd systemd-hwdb-update systemd-journal-flush systemd-binfmt systemd-pstore systemd-firstboot \
  systemd-update-utmp systemd-remount-fs systemd-random-seed systemd-update-done systemd-machine-id-commit \
  systemd-modules-load systemd-network-generator systemd-sysusers systemd-udev-trigger kmod-static-nodes ldconfig \
  e2scrub_reap keyboard-setup console-setup apparmor ifupdown networking; do
  ln -sf /dev/null $units/$unit.service
done
for unit in man-db apt-daily apt-daily-upgrade fstrim logrotate dpkg-db-backup; do
  ln -sf /dev/null $units/$unit.timer
done
for unit in dev-hugepages dev-mqueue sys-kernel-debug sys-kernel-tracing sys-fs-fuse-connections; do
  ln -sf /dev/null $units/$unit.mount
done
mkdir -p /run/systemd/system-generators
for generator in /lib/systemd/system-generators/*; do ln -s /dev/null "/run/systemd/system-generators/${generator##*/}"; done
# Not a fresh machine: what lies in /tmp may be the tree that is tested.
mkdir -p /run/tmpfiles.d
ln -s /dev/null /run/tmpfiles.d/tmp.conf
: >/etc/fstab
tr -d - </proc/sys/kernel/random/uuid >/etc/machine-id # else: a first boot, which presets every unit
exec /lib/systemd/systemd --unit=job.target --show-status=0 --log-level=warning
