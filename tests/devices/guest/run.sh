#!/usr/bin/env bash
# run.sh [-t SECONDS] [-m MODULES] [-s] [-d BYTES] CACHE DIRECTORY JOB [VARIABLE=VALUE...]
# Boots the guest machine that prepare.sh made in CACHE (QEMU without KVM: Debian's kernel hangs under nested KVM), runs
# the shell file JOB in it as root and exits with its status. The guest sees this machine's / read-only below an overlay
# in memory, at the same paths; DIRECTORY, made empty, is shared: the job's working directory, for what it leaves behind.
#   -t  time limit, 300 s            -m  modules to load, as "v4l2loopback:video_nr=10,card_label=Sim dummy_hcd"
#   -s  the job runs as a unit under a real systemd as PID 1
#   -d  /dev/vda is a disk of 64 MB that takes so many bytes in a second (module virtio_blk)
# Exit status: the job's; 77 this machine cannot run a guest; 124 time limit; 125 the guest never reported.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
limit=300 modules='' systemd=0 disk=()
while getopts t:m:sd: option; do
  case $option in
    t) limit=$OPTARG ;;
    m) modules=$OPTARG ;;
    s) systemd=1 ;;
    d) disk=("$OPTARG") ;;
    *) exit 64 ;;
  esac
done
shift $((OPTIND - 1))
cache=$1 directory=$2 job=$(realpath "$3")
shift 3

"$here/prepare.sh" "$cache"
kernel=$(realpath "$cache/current")
version=$(cut -d' ' -f1 "$kernel/stamp")
rm -rf "$directory"
mkdir -p "$directory"
directory=$(realpath "$directory")

{
  printf 'job=%q version=%q modules=%q systemd=%q\n' "$job" "$version" "$modules" "$systemd"
  for variable in "$@"; do printf 'export %q\n' "$variable"; done
} >"$directory/settings.sh"
cp "$here/boot.sh" "$directory/boot.sh"

if [ ${#disk[@]} -gt 0 ]; then
  truncate -s 64M "$directory/disk"
  disk=(-drive "file=$directory/disk,if=virtio,format=raw,throttling.bps-total=${disk[0]}")
fi
share() { # DIRECTORY TAG: as options of qemu
  echo -virtfs "local,path=$1,mount_tag=$2,security_model=none,multidevs=remap${3:+,$3}"
}
# The guest would measure the rate of its processor's clocks at boot, and on a busy machine gets it wrong by any factor:
# it keeps time by the emulated HPET, whose rate is known.
# For the same reason it must not judge at boot whether its timer ticks.
clock="clocksource=hpet nolapic_timer no_timer_check"
status=0
# One processor: on a busy machine two take longer, because each waits for the other.
timeout -k 5 "$limit" qemu-system-x86_64 -M q35 -accel tcg -cpu max -smp 1 -m 1024 -nodefaults -no-user-config \
  -display none -no-reboot -kernel "$kernel/vmlinuz" -initrd "$kernel/initrd.gz" \
  -append "console=ttyS0 quiet loglevel=3 panic=-1 oops=panic mitigations=off $clock" -serial stdio \
  $(share / host readonly=on) $(share "$directory" job) $(share "$kernel/kernel" kernel readonly=on) \
  -device virtio-rng-pci "${disk[@]}" </dev/null || status=$?
case $status in 124 | 137) echo "guest: not done after $limit s" >&2; exit 124 ;; esac
[ -s "$directory/status" ] || { echo "guest: ended without a report (panic?)" >&2; exit 125; }
exit "$(cat "$directory/status")"
