# The T265's driver against a fake device on raw_gadget, first with USB 3 ports. With udevd, as on a real machine:
# libusb learns of devices from it.
/lib/systemd/systemd-udevd --daemon
# Of a size that ends neither with a transfer nor with a packet.
head -c 3145733 /dev/urandom >/job/firmware.mvcmd
export FIRMWARE=/job/firmware.mvcmd
FIRMWARE_SHA1=$(sha1sum $FIRMWARE | cut -d' ' -f1)
export FIRMWARE_SHA1
"$CA2_BIN/t265_in_guest"
status=$?
[ $status = 0 ] || dmesg | tail -30
exit $status
