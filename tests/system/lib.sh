# What the system tests share: a network namespace of their own, a daemon on a configuration of their own, and words to
# say what is expected. Source it first. CA2_BIN is where the programs are.
set -u
: "${CA2_BIN:?names the directory of ca2d and ca2}"

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

clean_up() {
  local status=$?
  for pid in "${OTHERS[@]}"; do kill "$pid" 2>/dev/null; done
  [ -n "$DAEMON" ] && kill -9 "$DAEMON" 2>/dev/null
  if [ $status -ne 0 ] && [ $status -ne 77 ]; then
    echo "--- the daemon's log"
    tail -40 "$WORK/log" 2>/dev/null
  fi
  umount "$WORK/state" 2>/dev/null
  rm -rf "$WORK"
}
trap clean_up EXIT

fail() { echo "FAILED: $*"; exit 1; }
step() { echo "* $*"; }

ca2() { timeout 60 "$CA2_BIN/ca2" "$@"; }
# A field of the status: field .state
field() { ca2 status --json 2>/dev/null | jq -r "$1"; }

# wait_for SECONDS COMMAND...: until it succeeds.
wait_for() {
  local end=$((SECONDS + $1))
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

# start_daemon ARGUMENTS...: returns when it answers.
start_daemon() {
  "$CA2_BIN/ca2d" "$@" >>"$WORK/log" 2>&1 &
  DAEMON=$!
  wait_for 20 ca2 status --json >/dev/null 2>&1 || fail "the daemon does not answer"
}

# Sends a signal (TERM) and returns its exit status; more than two seconds are a failure.
stop_daemon() {
  local begin=${EPOCHREALTIME/./} status=0
  kill "-${1:-TERM}" "$DAEMON"
  wait "$DAEMON" || status=$?
  DAEMON=
  local ms=$(((${EPOCHREALTIME/./} - begin) / 1000))
  [ $ms -lt "${CA2_STOP_MS:-2000}" ] || fail "stopping took $ms ms"
  return $status
}

# In the background until the test ends.
beside() { "$@" & OTHERS+=($!); }

# A simulated recording of a board that is carried and held, made once for all tests of a build.
recording() {
  local made=$CA2_BIN/system-recording source
  source=$(dirname "$0")/scenario.yaml
  if [ ! -e "$made/made-of" ] || ! cmp -s "$source" "$made/made-of"; then
    rm -rf "$made"
    "$CA2_BIN/ca2" simulate "$source" --recording --output "$made" >/dev/null || fail "no recording"
    cp "$source" "$made/made-of"
  fi
  echo "$made"
}

# live_sensors RECORDING: its pictures from a GigE camera, its packets over UDP, both in time from now on, in a configuration that
# takes them. The camera is process $CAMERA; start_camera starts it again.
live_sensors() {
  [ -x "$CA2_BIN/fake_gige_camera" ] || skip "built without Aravis"
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
