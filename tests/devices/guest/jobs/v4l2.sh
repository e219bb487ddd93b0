# The V4L2 driver against v4l2loopback and vivid. With udevd, as on a real machine: it makes the names that stay.
/lib/systemd/systemd-udevd --daemon
udevadm trigger --subsystem-match=video4linux --settle
"$CA2_BIN/v4l2_in_guest"
status=$?
[ $status = 0 ] || { ls -lR /dev/v4l; dmesg | tail -30; }
exit $status
