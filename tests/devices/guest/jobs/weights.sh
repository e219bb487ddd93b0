# What the unit's weights do beside another service, under a real systemd: a processor and a disk that both want more of
# than there is. Two services that are nothing but load, one with the weights of the unit as it is shipped.
units=/run/systemd/system
weights=$(grep -E '^(CPUWeight|IOWeight)=' "$CA2_SOURCE/systemd/ca2d.service.in")
fail() { echo "FAILED: $*"; exit 1; }

# service NAME SETTINGS SCRIPT
service() {
  printf '%s\n' "$3" >/run/"$1".sh
  printf '[Service]\n%s\nExecStart=/bin/sh /run/%s.sh\n' "$2" "$1" >$units/"$1".service
}
loops() { echo "for i in $(seq -s ' ' "$1"); do while :; do :; done & done; wait"; }
# Every service at its own place of the disk.
writer() { echo "while :; do dd if=/dev/zero of=/dev/vda bs=64k count=256 seek=$1 oflag=direct status=none; done"; }
cpu() { sed -n 's/^usage_usec //p' /sys/fs/cgroup/system.slice/"$1".service/cpu.stat; }
io() { sed -n 's/.*wbytes=\([0-9]*\).*/\1/p' /sys/fs/cgroup/system.slice/"$1".service/io.stat; }

# share cpu|io SECONDS: sets $percent, what `ours` has of what both get.
share() {
  systemctl daemon-reload
  systemctl --quiet start ours robot
  sleep 2
  ours=$($1 ours) robot=$($1 robot)
  sleep "$2"
  ours=$(($($1 ours) - ours)) robot=$(($($1 robot) - robot))
  systemctl --quiet stop ours robot
  percent=$((100 * ours / (ours + robot)))
}

service robot "" "$(loops 2)"
service ours "" "$(loops 8)"
share cpu 10
echo "processor, 8 busy loops beside 2, no weights: $percent %"
[ $percent -ge 70 ] || fail "a processor that is shared by thread would give 80 %"
service ours "$weights" "$(loops 8)"
share cpu 10
echo "processor, 8 busy loops beside 2, the unit's weights: $percent %"
[ $percent -ge 40 ] && [ $percent -le 60 ] || fail "half was to be had"

queue=/sys/block/vda/queue
service robot "" "$(writer 0)"
service ours "$weights" "$(writer 512)"
for scheduler in mq-deadline bfq; do
  echo $scheduler >$queue/scheduler || fail "no scheduler $scheduler"
  share io 20
  echo "disk, one writer beside one, the unit's weights, $scheduler: $percent %"
done
[ $percent -ge 20 ] && [ $percent -le 45 ] || fail "BFQ was to give a third"
