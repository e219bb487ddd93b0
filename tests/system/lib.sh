# What the system tests share: a network namespace of their own, a daemon on a configuration of their own, and words to
# say what is expected. Source it first. CA2_BIN is where the programs are.
set -u
: "${CA2_BIN:?names the directory of ca2d and ca2}"

# How many times slower the programs are than a release: a build with sanitizers says so.
SLOWER=${CA2_SLOWER:-1}

skip() { echo "skipped: $*"; exit 77; }

# Again, in namespaces: LCM's multicast must not meet another test's, and a full disk must not be the machine's.
if [ -z "${CA2_IN_NAMESPACE:-}" ]; then
  unshare --net --mount --map-root-user true 2>/dev/null || skip "no namespaces for this user"
  CA2_IN_NAMESPACE=1 exec unshare --net --mount --map-root-user "$0" "$@"
fi
ip link set lo up && ip route add 224.0.0.0/4 dev lo || skip "no routes in the namespace"

WORK=$(mktemp -d /tmp/ca2-system-XXXXXX)
DAEMON=
OTHERS=()
export CA2_SOCKET=$WORK/control.sock
# What a build with sanitizers finds; nothing that is found is forgiven for how the program ended.
FOUND=$WORK/sanitizer
export ASAN_OPTIONS="log_path=$FOUND${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
export UBSAN_OPTIONS="log_path=$FOUND:print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}"
export TSAN_OPTIONS="log_path=$FOUND:second_deadlock_stack=1:suppressions=$(cd "$(dirname "$0")/.." && pwd)/sanitizers/thread.supp${TSAN_OPTIONS:+:$TSAN_OPTIONS}"
export LSAN_OPTIONS="suppressions=$(cd "$(dirname "$0")/.." && pwd)/sanitizers/leak.supp${LSAN_OPTIONS:+:$LSAN_OPTIONS}"

clean_up() {
  local status=$?
  for pid in "${OTHERS[@]}"; do kill "$pid" 2>/dev/null; done
  [ -n "$DAEMON" ] && kill -9 "$DAEMON" 2>/dev/null
  if [ $status -ne 0 ] && [ $status -ne 77 ]; then
    echo "--- the daemon's log"
    tail -40 "$WORK/log" 2>/dev/null
  fi
  if compgen -G "$FOUND.*" >/dev/null; then
    echo "--- the sanitizers found"
    cat "$FOUND".*
    status=1
  fi
  umount "$WORK/state" 2>/dev/null
  rm -rf "$WORK"
  exit $status
}
trap clean_up EXIT

fail() { echo "FAILED: $*"; exit 1; }
step() { echo "* $*"; }

ca2() { timeout $((60 * SLOWER)) "$CA2_BIN/ca2" "$@"; }
# A field of the status: field .state
field() { ca2 status --json 2>/dev/null | jq -r "$1"; }

# wait_for SECONDS COMMAND...: until it succeeds.
wait_for() {
  local end=$((SECONDS + $1 * SLOWER))
  shift
  until "$@"; do
    [ $SECONDS -ge $end ] && return 1
    sleep 0.1
  done
}
is() { [ "$(field "$1")" = "$2" ]; }
at_least() { local value; value=$(field "$1"); [ "${value:-null}" != null ] && [ "$value" -ge "$2" ]; }
logged() { grep -q "$1" "$WORK/log"; }

# expect_status CODE COMMAND...: its output is in $WORK/out, its errors in $WORK/err.
expect_status() {
  local wanted=$1 got=0
  shift
  "$@" >"$WORK/out" 2>"$WORK/err" || got=$?
  [ "$got" -eq "$wanted" ] || { cat "$WORK/out" "$WORK/err"; fail "'$*' ended with $got, not $wanted"; }
}

# A rig of a virtual camera and a LiDAR on a port where nothing comes unless a test sends it.
write_config() {
  cat >"$WORK/ca2d.yaml" <<EOF
version: 1
board: {type: checkerboard, columns: 8, rows: 6, square: 0.040, outline: {width: 0.420, height: 0.297}}
cameras:
  left:
    frame: left_optical
    image_size: [640, 480]
    intrinsics: {model: pinhole_radtan, parameters: [500, 500, 320, 240, 0, 0, 0, 0]}
    source: {driver: pattern, frame_rate: 10}
lidars:
  top: {frame: top_lidar, model: VLP-16, source: {driver: velodyne, port: 2368}}
state: {directory: $WORK/state}
control: {socket: $WORK/control.sock, keys: $WORK/keys}
${1:-}
EOF
}

# start_daemon ARGUMENTS...: returns when it answers. Whoever wants it run by another program says so in DAEMON_PREFIX.
DAEMON_PREFIX=()
start_daemon() {
  "${DAEMON_PREFIX[@]}" "$CA2_BIN/ca2d" "$@" >>"$WORK/log" 2>&1 &
  DAEMON=$!
  wait_for 20 ca2 status --json >/dev/null 2>&1 || fail "the daemon does not answer"
}

# "THREAD ns" of each of a process's threads: how long it was ready to run while others had the processors.
kept_waiting() { awk '{ split(FILENAME, part, "/"); print part[5], $2 }' "/proc/$1"/task/*/schedstat 2>/dev/null; }

# Sends a signal (TERM) and returns its exit status; more than two seconds are a failure. What the thread that was kept
# waiting longest for a processor waited does not count: that is the machine's time, not the daemon's.
stop_daemon() {
  local begin=${EPOCHREALTIME/./} status=0 watcher
  kept_waiting "$DAEMON" >"$WORK/waits.before"
  cp "$WORK/waits.before" "$WORK/waits"
  (while kept_waiting "$DAEMON" >"$WORK/waits.new" && [ -s "$WORK/waits.new" ]; do
    mv "$WORK/waits.new" "$WORK/waits"
    sleep 0.02
  done) &
  watcher=$!
  kill "-${1:-TERM}" "$DAEMON"
  wait "$DAEMON" || status=$?
  local ms=$(((${EPOCHREALTIME/./} - begin) / 1000))
  DAEMON=
  kill "$watcher" 2>/dev/null
  wait "$watcher" 2>/dev/null
  local waited
  waited=$(awk 'NR == FNR { before[$1] = $2; next } { w = ($2 - before[$1]) / 1e6; if (w > most) most = w }
                END { printf "%d", most }' "$WORK/waits.before" "$WORK/waits")
  [ $((ms - waited)) -lt $((${CA2_STOP_MS:-2000} * SLOWER)) ] || fail "stopping took $ms ms, $waited of them for want of a processor"
  return $status
}

# In the background until the test ends.
beside() { "$@" & OTHERS+=($!); }

# A simulated recording of a board that is carried and held, made once for all tests of a build; for slow programs it is
# held for longer, before a slower camera.
recording() {
  local made=$CA2_BIN/system-recording scenario=$WORK/scenario.yaml
  awk -v n="$SLOWER" '/^recording:/ { $0 = sprintf("recording: {hold: [%g, %g], move: [0.8, 1.2], away: 0, camera_rate: %g}",
    1.6 * n, 2 * n, n > 1 ? 5 : 10) } { print }' "$(dirname "$0")/scenario.yaml" >"$scenario"
  if [ ! -e "$made/made-of" ] || ! cmp -s "$scenario" "$made/made-of"; then
    rm -rf "$made"
    "$CA2_BIN/ca2" simulate "$scenario" --recording --output "$made" >/dev/null || fail "no recording"
    cp "$scenario" "$made/made-of"
  fi
  echo "$made"
}

# live_sensors RECORDING: its pictures from a GigE camera, its packets over UDP, both in time from now on, in a configuration that
# takes them. The camera is process $CAMERA; start_camera starts it again.
live_sensors() {
  [ -x "$CA2_BIN/fake_gige_camera" ] || skip "built without Aravis"
  # Aravis and GLib are built without instrumentation and lock by futexes that the thread sanitizer does not see: every packet
  # would be a race of theirs, and looking each up takes the receiving thread a whole processor, so that pictures are lost.
  # What they ask of the C library is not judged; our code is, and so are our handlers that they call.
  export TSAN_OPTIONS="$TSAN_OPTIONS:ignore_noninstrumented_modules=1"
  RECORDED=$1
  ip address add 127.0.0.2/8 dev lo
  {
    sed -e '/^software:/d; /^start:/d' "$RECORDED/recording.yaml" | awk '
      { print }
      /image_size:/ { print "    source: {driver: aravis, id: 127.0.0.2, width: 640, height: 480, frame_rate: 10, silence: 1}" }
      /model: VLP-16/ { print "    source: {driver: velodyne}" }'
    echo "state: {directory: $WORK/state}"
    echo "control: {socket: $WORK/control.sock, keys: $WORK/keys}"
  } >"$WORK/ca2d.yaml"
  SHIFT=$(($(date +%s%N) + 2000000000 - $(awk '$1 == "start:" { print $2 }' "$RECORDED/recording.yaml")))
  start_camera
  # When the film is over, the packets go on.
  (
    "$CA2_BIN/ca2" play "$RECORDED/lidars/puck.pcap" --to 127.0.0.1 --shift $SHIFT
    while "$CA2_BIN/ca2" play "$RECORDED/lidars/puck.pcap" --to 127.0.0.1; do :; done
  ) >/dev/null 2>&1 &
  OTHERS+=($!)
}
start_camera() {
  "$CA2_BIN/fake_gige_camera" 127.0.0.2 front 0 "$RECORDED/cameras/front" $SHIFT >/dev/null 2>&1 &
  CAMERA=$!
  OTHERS+=($CAMERA)
}
