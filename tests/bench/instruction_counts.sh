#!/usr/bin/env bash
# The instructions that what takes the time takes, against instruction_counts.txt: unlike times they are the same on a
# busy machine. More than 15 % over fails. Where a change has its price, or has gained something:
#   tests/bench/instruction_counts.sh --renew build/release/bin/hot_functions
# with Debian's compiler, in the release preset, on a processor with AVX2; commit the file with the change.
# Skipped (77) without valgrind or AVX2: the other loops take other numbers. Valgrind has no AVX-512.
set -u
renew=
[ "${1:-}" = --renew ] && { renew=1; shift; }
program=${1:?usage: instruction_counts.sh [--renew] PROGRAM}
figures=$(dirname "$0")/instruction_counts.txt
head_room=15  # per cent
command -v valgrind >/dev/null || { echo "valgrind is not installed: apt install valgrind"; exit 77; }
grep -qw avx2 /proc/cpuinfo || { echo "this processor has no AVX2"; exit 77; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for name in $("$program"); do
  valgrind --tool=callgrind --collect-atstart=no --toggle-collect="hot_$name" --callgrind-out-file=/dev/null \
    "$program" "$name" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
  count=$(sed -n 's/^==[0-9]*== Collected : //p' "$scratch/log")
  [ "${count:-0}" -gt 0 ] || { echo "$name: nothing was counted"; cat "$scratch/log"; exit 1; }
  echo "$name $count" >>"$scratch/counted"
done

if [ -n "$renew" ]; then
  { grep '^#' "$figures"; cat "$scratch/counted"; } >"$scratch/renewed"
  cp "$scratch/renewed" "$figures"
  cat "$figures"
  exit
fi
status=0
while read -r name limit; do
  count=$(awk -v name="$name" '$1 == name { print $2 }' "$scratch/counted")
  if [ -z "$count" ]; then
    echo "$name: not counted"
    status=1
  elif [ $((count * 100)) -gt $((limit * (100 + head_room))) ]; then
    echo "$name: $count instructions, $((count * 100 / limit - 100)) % more than $limit (see $0)"
    status=1
  else
    echo "$name: $count instructions, $((count * 100 / limit)) % of $limit"
  fi
done < <(grep -v '^#' "$figures")
# What is run without a figure would never fail.
[ "$(wc -l <"$scratch/counted")" -eq "$(grep -vc '^#' "$figures")" ] || { echo "$figures does not name what was run"; status=1; }
exit $status
