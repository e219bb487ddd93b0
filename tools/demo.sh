#!/usr/bin/env bash
# The real thing without hardware: the daemon on simulated sensors. A person who carries the board is simulated as true
# packets and pictures, which come back in real time: the LiDARs' over UDP, the cameras' over GigE Vision (GVCP, GVSP).
# The daemon captures by itself; its status is shown as it changes. Then the answer with its sigma and its true error, a
# picture and a report to open. Without the right to make a network namespace the recording is replayed instead.
# Usage: ./tools/demo.sh [SCENARIO.yaml [HOLDS]]   (see config/scenarios)
set -euo pipefail
cd "$(dirname "$0")/.."
scenario=${1:-config/scenarios/paper.yaml}
holds=${2:-8}
name=$(basename "$scenario" .yaml)
demo=$PWD/demo/$name recording=$PWD/demo/$name/recording
bin=build/release/bin
export CA2_SOCKET=$demo/control.sock

# A rig as its recording states it, with sources: what a ca2d.yaml for these sensors says. LiDAR ports are those of the
# packets, cameras are at 127.0.0.2 and on.
live_config() {
  awk -v rate="$1" '
    /^[a-z]/ { section = $1 }
    /^(software|start):/ { next }
    { print }
    section == "cameras:" && /image_size:/ { gsub(/[^0-9,]/, ""); split($0, size, ","); camera(size[1], size[2]) }
    section == "lidars:" && /(model|metadata):/ {
      print "    source: {driver: " ($0 ~ /metadata/ ? "ouster" : "velodyne") "}" }
    function camera(width, height) {
      printf "    source: {driver: aravis, id: 127.0.0.%d, width: %d, height: %d, frame_rate: %s, silence: 2}\n",
        2 + cameras++, width, height, rate }' "$recording/recording.yaml"
  printf 'state: {directory: "%s/state"}\ncontrol: {socket: "%s"}\n' "$demo" "$CA2_SOCKET"
}

started=()  # processes that end with the demo

# In a network of its own: nothing of it is heard outside, nobody else's cameras are in the way.
live() {
  local players=() address=2 camera pcap start shift
  trap 'kill "${started[@]}" 2>/dev/null || true; wait' EXIT
  ip link set lo up
  ip route add 224.0.0.0/4 dev lo
  # What was recorded is shown again that much later: cameras and packets keep together.
  start=$(awk '$1 == "start:" { print $2 }' "$recording/recording.yaml")
  shift=$(($(date +%s%N) + 5000000000 - start))
  for camera in "$recording"/cameras/*; do
    ip address add 127.0.0.$address/8 dev lo
    "$bin/fake_gige_camera" 127.0.0.$address "$(basename "$camera")" 0 "$camera" $shift >/dev/null &
    started+=($!)
    address=$((address + 1))
  done
  "$bin/ca2d" --config "$recording/live.yaml" 2>"$demo/ca2d.log" &
  local daemon=$!
  started+=("$daemon")
  until "$bin/ca2" status --json 2>/dev/null | jq -e '[.sensors[] | .supervision == "running"] | all' >/dev/null; do
    kill -0 "$daemon" 2>/dev/null || { tail "$demo/ca2d.log" >&2; exit 1; }
    sleep 0.2
  done
  "$bin/ca2" status --watch &
  local watch=$!
  started+=("$watch")
  for pcap in "$recording"/lidars/*.pcap; do
    "$bin/ca2" play "$pcap" --to 127.0.0.1 --shift $shift >/dev/null &
    players+=($!)
  done
  started+=("${players[@]}")
  wait "${players[@]}"
  kill "$watch"
  wait "$watch" || true
  echo
  "$bin/ca2" status
  kill "$daemon"
  wait "$daemon"
}

if [ -n "${CA2_DEMO_LIVE:-}" ]; then
  live
  exit
fi

begin=$SECONDS
./tools/install-packages.sh
echo "building (the first time takes some minutes) ..."
cmake --preset release -G Ninja >/dev/null
cmake --build --preset release --target ca2 ca2d fake_gige_camera
set_up=$((SECONDS - begin)) begin=$SECONDS

rm -rf "$demo"
mkdir -p "$demo"
echo "simulating $scenario, $holds holds ..."
"$bin/ca2" simulate "$scenario" --views "$holds" --output "$recording" --recording
# Pictures per second, as their names, ns, say.
rate=$(ls "$recording"/cameras/* | awk '/[.]png/ { n++; if (!first) first = $1 + 0; last = $1 + 0 }
  /:$/ { first = n = 0 } END { printf "%.3f", 1e9 * (n - 1) / (last - first) }')
live_config "$rate" >"$recording/live.yaml"
if unshare --net --map-root-user true 2>/dev/null; then
  echo "the daemon, live: $(ls "$recording"/cameras | wc -l) cameras over GigE Vision, $(ls "$recording"/lidars/*.pcap | wc -l) LiDAR over UDP"
  CA2_DEMO_LIVE=1 unshare --net --map-root-user "$0" "$@"
else
  echo "demo: no right to make a network namespace (in a container: --cap-add SYS_ADMIN), so not live:"
  echo "the recording goes through the daemon's pipeline offline ..."
  "$bin/ca2" replay "$recording" --session "$demo/state/sessions/replayed"
fi

session=$(echo "$demo"/state/sessions/*)
cp "$recording/truth.yaml" "$session"
echo
"$bin/ca2" solve "$session"
"$bin/ca2" report "$session" >/dev/null
echo
echo "the points on a picture: $session/report/overlay.png"
echo "the report:              $session/report/index.html"
[ ! -f "$demo/ca2d.log" ] || echo "the daemon's log:        $demo/ca2d.log"
echo "took $((SECONDS - begin)) s after $set_up s of set-up"
