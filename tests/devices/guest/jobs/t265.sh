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
grep -q 'T265' sensors.txt && grep -q 908412110993 sensors.txt
