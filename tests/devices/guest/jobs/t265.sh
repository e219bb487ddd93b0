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
"$CA2_BIN/t265_in_guest"
status=$?
[ $status = 0 ] || dmesg | tail -30
exit $status
