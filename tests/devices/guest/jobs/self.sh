# The guest is what jobs rely on: ours alone to write to, with the host's files, the modules and devices; exits with 7.
set -e
[ "$GREETING" = "two words" ]
touch /etc/written-by-the-guest
grep -q '^host / 9p ro' /proc/mounts || grep -q 'overlay / overlay rw' /proc/mounts
[ -c /dev/video10 ]
[ -c /dev/raw-gadget ]
[ -d /sys/class/udc/dummy_udc.0 ]
echo "left behind" >left-behind
exit 7
