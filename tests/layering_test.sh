#!/usr/bin/env bash
# Includes run in one direction: core <- drivers <- daemon; tools may use core, drivers and messages; messages only core.
# And inside core the folders form layers too. Prints every include against the direction; exit status 1 if there is one.
set -u
cd "$(dirname "$0")/.."
bad=0

# forbid LAYER PATTERN: no file under LAYER includes a path that matches PATTERN.
forbid() {
  local found
  found=$(grep -rnE "^#include \"($2)" "$1" --include=*.h --include=*.cpp --include=*.def 2>/dev/null)
  [ -z "$found" ] && return
  echo "$1 must not include $2:"
  echo "$found"
  bad=1
}

forbid core 'drivers/|messages/|daemon/|tools/'
forbid drivers 'messages/|daemon/|tools/'
forbid messages 'drivers/|daemon/|tools/'
forbid daemon 'tools/'
forbid tools 'daemon/'
forbid tools/sim 'tools/ca2/'

# types and geometry know nothing else; sensors' sides know no sessions and no solver.
forbid core/types 'core/(geometry|camera|board|lidar|features|session|solve|report|io|capture)/'
forbid core/geometry 'core/(camera|board|lidar|features|session|solve|report|io|capture)/'
forbid core/camera 'core/(board|intrinsics|lidar|features|session|solve|report|io|capture)/'
forbid core/board 'core/(intrinsics|lidar|features|session|solve|report|io|capture)/'
forbid core/intrinsics 'core/(lidar|features|session|solve|report|io|capture)/'
forbid core/lidar 'core/(intrinsics|features|session|solve|report|io|capture)/'
forbid core/session 'core/(features|solve|report|export|capture)/'
forbid core/features 'core/(report|export|capture)/'
forbid core/export 'core/(features|intrinsics|lidar|solve|report|capture)/'

# core is pure: no clocks, sockets, devices or logging.
impure=$(grep -rnE '^#include <(sys/socket|netinet/|arpa/|linux/|spdlog|chrono|ctime|iostream|libusb|arv)' core --include=*.h --include=*.cpp)
[ -z "$impure" ] || { echo "core must be pure:"; echo "$impure"; bad=1; }

# A registry's row is there once: two merged versions of one row would register it twice.
while read -r table; do
  twice=$(grep -oE '^[A-Z0-9_]+\([^,)]+' "$table" | sort | uniq -d)
  [ -z "$twice" ] || { echo "$table has rows twice:"; echo "$twice"; bad=1; }
done < <(find core drivers tools messages -name '*.def' 2>/dev/null)

# Files stay small.
while read -r lines file; do
  [ "$file" != total ] && [ "$lines" -gt 450 ] && { echo "$file has $lines lines, 450 are the most"; bad=1; }
done < <(find core drivers messages daemon tools tests -name '*.cpp' -o -name '*.h' | xargs wc -l)

exit $bad
