# The T265's driver against a fake device on raw_gadget. With udevd and our rules, as on a real machine: libusb learns of
# devices from it.
groupadd -r -f ca2
mkdir -p /run/udev/rules.d
cp "$CA2_SOURCE"/systemd/*.rules /run/udev/rules.d/
/lib/systemd/systemd-udevd --daemon
# Of a size that ends neither with a transfer nor with a packet.
head -c 1100007 /dev/urandom >/job/firmware.mvcmd
export FIRMWARE=/job/firmware.mvcmd
FIRMWARE_SHA1=$(sha1sum $FIRMWARE | cut -d' ' -f1)
export FIRMWARE_SHA1
"$CA2_BIN/t265_in_guest" || { dmesg | tail -30; exit 1; }

# As a person uses it.
"$CA2_BIN/fake_t265" loader super $FIRMWARE &
for _ in 1 2 3 4 5 6 7 8 9 10; do
  grep -qs 03e7 /sys/bus/usb/devices/*/idVendor && break
  sleep 0.5
done
"$CA2_BIN/ca2" snap "t265:imager=right,firmware=$FIRMWARE,firmware_sha1=$FIRMWARE_SHA1,silence=4" right.png || exit 1
"$CA2_BIN/ca2" check right.png | tee check.txt
grep -q '848 x 800' check.txt || exit 1
"$CA2_BIN/ca2" sensors --cameras | tee sensors.txt
grep -q 'T265' sensors.txt && grep -q 908412110993 sensors.txt || exit 1
kill $!

# As the daemon uses it: each imager is told its own losses, here of every third picture of the right one.
"$CA2_BIN/fake_t265" camera super $FIRMWARE limps &
cat >ca2d.yaml <<YAML
version: 1
board: {type: checkerboard, columns: 8, rows: 6, square: 0.040}
cameras:
  left: {frame: left, source: {driver: t265, imager: left, silence: 4}}
  right: {frame: right, source: {driver: t265, imager: right, silence: 4}}
state: {directory: /run/ca2/state}
control: {socket: /run/ca2/control.sock, keys: /run/ca2/keys}
YAML
export CA2_SOCKET=/run/ca2/control.sock
mkdir -p /run/ca2 # sockets cannot be in the shared directory
"$CA2_BIN/ca2d" --config ca2d.yaml >ca2d.log 2>&1 &
daemon=$!
lost() { jq ".sensors[] | select(.name == \"$1\") | .lost" status.json; }
for _ in $(seq 60); do
  "$CA2_BIN/ca2" status --json >status.json 2>/dev/null
  right=$(lost right)
  [ "${right:-0}" -ge 3 ] && break
  sleep 1
done
left=$(lost left)
echo "lost: left $left, right $right"
# The guest may be too slow for all that comes and lose some of either beside.
[ "${right:-0}" -ge 3 ] && [ "$left" -lt "$right" ] || { cat ca2d.log status.json; exit 1; }
kill $daemon
wait $daemon
