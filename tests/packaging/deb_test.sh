#!/usr/bin/env bash
# The Debian packages as they are: what is in them, what lintian says, every command's --help, manual page and completion
# from the unpacked files, a program built from the development files. Usage: deb_test.sh DIRECTORY_WITH_DEBS
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
debs=$(realpath "${1:?usage: deb_test.sh DIRECTORY}")
ls "$debs"/ca2_*.deb >/dev/null 2>&1 || { echo "no packages in $debs: run cpack there first"; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for deb in "$debs"/*.deb; do
  name=$(dpkg-deb -f "$deb" Package)
  dpkg-deb -x "$deb" "$work/$name"
  [ -s "$work/$name/usr/share/doc/$name/copyright" ]
  if command -v lintian >/dev/null; then
    lintian --allow-root --fail-on error,warning --tag-display-limit 0 "$deb" || { echo "lintian: $deb"; exit 1; }
  fi
done
"$here/overview_test.sh" "$work/ca2/usr/bin/ca2" "$work/ca2/usr/share/bash-completion/completions/ca2" \
  "$work/ca2/usr/share/man/man1/ca2.1.gz"
if [ -d "$work/ca2d" ]; then
  "$work/ca2d/usr/bin/ca2d" --help >/dev/null
  grep -qx /etc/ca2/ca2d.yaml <(dpkg-deb --ctrl-tarfile "$debs"/ca2d_*.deb | tar -xO ./conffiles)
fi
# Every link between the installed manuals leads somewhere.
(cd "$work/ca2/usr/share/doc/ca2" && grep -oE '\]\([a-z0-9/_.-]+\)' -- *.md | tr -d ']()' | sort -u |
  while IFS=: read -r page link; do [ -e "${link#docs/}" ] || { echo "$page: broken link $link"; exit 1; }; done)
"$here/consumer_test.sh" "$work/libca2-dev/usr" "$work/ca2/usr/bin/ca2"
echo "packages: sound"
