# The unit as it is shipped, under a real systemd: it starts, a worker that is stuck ends it, systemd starts it again.
fail() {
  echo "FAILED: $*"
  journalctl -u ca2d --no-pager | tail -40
  systemctl status ca2d --no-pager
  exit 1
}
shown() { systemctl show -p "$1" --value ca2d; }
# wait_for SECONDS COMMAND...: until it succeeds.
wait_for() {
  left=$1
  shift
  until "$@"; do
    left=$((left - 1))
    [ $left -gt 0 ] || return 1
    sleep 1
  done
}

systemd-sysusers "$CA2_SOURCE/systemd/ca2.sysusers"
mkdir -p /etc/ca2
cat >/etc/ca2/ca2d.yaml <<'YAML'
version: 1
board: {type: checkerboard, columns: 8, rows: 6, square: 0.040}
cameras:
  left:
    frame: left_optical
    image_size: [320, 240]
    intrinsics: {model: pinhole_radtan, parameters: [250, 250, 160, 120, 0, 0, 0, 0]}
    source: {driver: pattern, width: 320, height: 240, frame_rate: 2}
lidars:
  top: {frame: top_lidar, model: VLP-16, source: {driver: velodyne, port: 2368}}
YAML
units=/run/systemd/system
sed "s#@CMAKE_INSTALL_FULL_BINDIR@#$CA2_BIN#" "$CA2_SOURCE/systemd/ca2d.service.in" >$units/ca2d.service
# The machine is emulated and slow: everything else is as shipped.
mkdir -p $units/ca2d.service.d
printf '[Service]\nWatchdogSec=10\nTimeoutStartSec=180\n' >$units/ca2d.service.d/test.conf
systemctl daemon-reload

systemctl start ca2d || fail "it does not start"
[ "$(shown ActiveState)" = active ] || fail "not active but $(shown ActiveState)"
[ "$(stat -c %U /proc/"$(shown MainPID)")" = ca2 ] || fail "not run as the user ca2"
"$CA2_BIN/ca2" status || fail "no status"
first=$(shown MainPID)
echo "runs as process $first: $(shown StatusText)"

nice_of() {
  for task in /proc/"$first"/task/*; do
    [ "$(cat "$task/comm")" != "$1" ] || sed 's/.*) //' "$task/stat" | cut -d' ' -f17
  done | sort -u
}
[ "$(nice_of "ca2-detector 1")" = 5 ] || fail "a detector's nice is $(nice_of "ca2-detector 1"): the filter of system calls?"
[ "$(nice_of ca2d)" = 0 ] || fail "the event loop's nice is $(nice_of ca2d)"

"$CA2_BIN/system_probe" freeze "$first" "ca2-detector 1" 300 &
restarted() { [ "$(shown NRestarts)" -ge 1 ] && [ "$(shown ActiveState)" = active ]; }
wait_for 120 restarted || fail "a stuck worker did not get it restarted"
journalctl -u ca2d --no-pager | grep -E "is stuck|atchdog" || fail "nothing is said of the watchdog"
journalctl -u ca2d --no-pager | grep -q "detector 1 is stuck" || fail "nobody says who is stuck"
[ "$(shown MainPID)" != "$first" ] || fail "the same process"
"$CA2_BIN/ca2" status || fail "no status after the restart"
echo "restarted as process $(shown MainPID)"

systemctl reload ca2d || fail "no reload"
begin=$(date +%s%N)
systemctl stop ca2d || fail "no stop"
echo "stopped after $((($(date +%s%N) - begin) / 1000000)) ms"
[ "$(shown Result)" = success ] || fail "ended with $(shown Result)"
