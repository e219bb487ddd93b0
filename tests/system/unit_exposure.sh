#!/usr/bin/env bash
# The unit is well formed, and exposed by no more than 2.0 as systemd-analyze counts. Usage: unit_exposure.sh UNIT
set -u
command -v systemd-analyze >/dev/null || { echo "skipped: no systemd-analyze"; exit 77; }
unit=$1
systemd-analyze security --offline=true --threshold=20 "$unit" | tail -1
[ "${PIPESTATUS[0]}" -eq 0 ] || { echo "exposed by more than 2.0"; exit 1; }
# Programs that are not installed here are no fault of the unit.
found=$(systemd-analyze verify "$unit" 2>&1 | grep "$(basename "$unit")" | grep -v -e "is not executable" -e "'man ")
[ -z "$found" ] || { echo "$found"; exit 1; }
