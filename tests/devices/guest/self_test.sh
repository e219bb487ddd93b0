#!/usr/bin/env bash
# self_test.sh CACHE DIRECTORY: the runner passes on a job's status, files and variables, keeps the host clean, and
# ends what takes too long.
set -u
here=$(cd "$(dirname "$0")" && pwd)
fail() { echo "self test: $*" >&2; exit 1; }

"$here/run.sh" -t 2 "$1" "$2" "$here/jobs/self.sh"
status=$?
[ $status -eq 77 ] && exit 77
[ $status -eq 124 ] || fail "the time limit gave status $status, not 124"

"$here/run.sh" -m "v4l2loopback:video_nr=10,card_label=Sim dummy_hcd raw_gadget" "$1" "$2" "$here/jobs/self.sh" \
  GREETING="two words"
status=$?
[ $status -eq 7 ] || fail "a job that exits with 7 gave status $status"
[ "$(cat "$2/left-behind")" = "left behind" ] || fail "the job's file did not come back"
[ ! -e /etc/written-by-the-guest ] || fail "the guest wrote to this machine"
exit 0
