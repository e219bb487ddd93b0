#!/usr/bin/env bash
# The daemon on a whole rig for a long time: ./tests/soak.sh RECORDING MINUTES, with the programs of CA2_BIN. The cameras show
# the recording's pictures over GigE Vision, its packets come over UDP, again and again; every round begins a session of its
# own, so that views are saved and solved in each. Every minute it says what the daemon takes, and at the end whether that
# grew. A recording: ca2 simulate config/scenarios/whole_rig.yaml --recording --output DIR. No part of the tests: it takes long.
[ $# -eq 2 ] || { echo "usage: CA2_BIN=... $0 RECORDING MINUTES" >&2; exit 64; }
. "$(dirname "$0")/system/lib.sh"
recording=$(realpath "$1") minutes=$2
[ -x "$CA2_BIN/fake_gige_camera" ] || skip "built without Aravis"

cameras=("$recording"/cameras/*)
for ((i = 0; i < ${#cameras[@]}; ++i)); do ip address add "127.0.0.$((i + 2))/8" dev lo; done
{
  sed '/^software:/d; /^start:/d' "$recording/recording.yaml" | awk -v root="$recording/" '
    /metadata:/ { sub(/metadata: /, "&" root); print; print "    source: {driver: ouster}"; next }
    { print }
    /image_size:/ {
      gsub(/[^0-9 ]/, ""); printf "    source: {driver: aravis, id: 127.0.0.%d, width: %d, height: %d, frame_rate: 30, packet_size: 8000, silence: 5}\n", 2 + n++, $1, $2
    }
    /model: (VLP|HDL|VLS)/ { print "    source: {driver: velodyne}" }'
  echo "state: {directory: $WORK/state}"
  echo "control: {socket: $WORK/control.sock, keys: $WORK/keys}"
} >"$WORK/ca2d.yaml"

# A round: the recording, and a second to spare.
begin=$(awk '$1 == "start:" { print $2 }' "$recording/recording.yaml")
last=$(basename "$(printf '%s\n' "${cameras[0]}"/*.png | tail -1)" .png)
length=$((last - begin + 1000000000))
shift=$(($(date +%s%N) + 40000000000 - begin))
for ((i = 0; i < ${#cameras[@]}; ++i)); do
  "$CA2_BIN/fake_gige_camera" "127.0.0.$((i + 2))" "$(basename "${cameras[i]}")" 0 "${cameras[i]}" $shift at_once $length >/dev/null 2>&1 &
  OTHERS+=($!)
done
# As the unit runs it: without the rings of raw sockets, which Aravis takes where it may.
DAEMON_PREFIX=(setpriv --bounding-set -net_raw --inh-caps -net_raw)
start_daemon --config "$WORK/ca2d.yaml"
for packets in "$recording"/lidars/*.pcap; do
  (for ((round = 0; ; ++round)); do
    "$CA2_BIN/ca2" play "$packets" --to 127.0.0.1 --shift $((shift + round * length)) || break
  done) >/dev/null 2>&1 &
  OTHERS+=($!)
done

memory() { awk -v what="$1:" '$1 == what { print int($2 / 1024) }' "/proc/$DAEMON/status"; }
# Of this minute alone, what no sample caught is in it too.
forget_most() { echo 5 >"/proc/$DAEMON/clear_refs"; }

sleep $(((begin + shift - $(date +%s%N)) / 1000000000 + 1))
forget_most
# Packets' numbers jump where a recording begins anew, which its LiDAR counts as a loss: a column of its own.
printf '%6s %8s %8s %9s %8s %8s %8s %8s %6s\n' minute 'RSS MB' 'most MB' frames pictures packets shed let_go views
echo '                                      lost     lost'
most=() frames=0 shed=0 let_go=0 views=0 since=$SECONDS
for ((minute = 1; minute <= minutes; ++minute)); do
  while [ $SECONDS -lt $((since + 60 * minute)) ]; do
    sleep $((length / 1000000000))
    # All but the losses begins anew with a session.
    read -r f s g v pictures packets old < <(field '[([.sensors[].frames] | add), ([.sensors[].shed] | add), ([.sensors[].let_go] | add), .views,
      ([.sensors[] | select(.kind == "camera").lost] | add), ([.sensors[] | select(.kind == "lidar").lost] | add), .session] | map(tostring) | join(" ")') || fail "the daemon does not answer"
    ca2 session new >/dev/null 2>&1 || continue
    rm -rf "$old"
    frames=$((frames + f)) shed=$((shed + s)) let_go=$((let_go + g)) views=$((views + v))
  done
  most+=("$(memory VmHWM)")
  printf '%6d %8d %8d %9d %8d %8d %8d %8d %6d\n' "$minute" "$(memory VmRSS)" "${most[-1]}" "$frames" "$pictures" "$packets" \
    "$shed" "$let_go" "$views"
  forget_most
done
[ "$views" -gt 0 ] || fail "no view was saved"
# The first two minutes find out how much they need.
settled=$(printf '%s\n' "${most[@]:2:3}" | sort -n | tail -1)
at_last=$(printf '%s\n' "${most[@]: -3}" | sort -n | head -1)
[ "${#most[@]}" -lt 8 ] || [ "$at_last" -le $((settled + settled / 10)) ] || fail "it grew from $settled MB to $at_last MB"
stop_daemon || fail "it did not end with 0"
