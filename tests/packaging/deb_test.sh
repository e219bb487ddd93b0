#!/usr/bin/env bash
# The Debian packages as they are: what is in them, what lintian says, every command's --help from the unpacked files; and,
# where mmdebstrap and root are there (CA2_CLEAN_ROOT=1 asks for it: it downloads a Debian), installed in a clean root,
# where every command helps, a session is solved by the newcomer's manual, and a purge leaves nothing.
# Usage: deb_test.sh DIRECTORY_WITH_DEBS.  Exit status 77: nothing to test.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
debs=$(realpath "${1:?usage: deb_test.sh DIRECTORY}")
ls "$debs"/ca2_*.deb >/dev/null 2>&1 || { echo "no packages in $debs: run cpack there first"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for deb in "$debs"/*.deb; do
  name=$(dpkg-deb -f "$deb" Package)
  dpkg-deb -x "$deb" "$work/$name"
  [ -s "$work/$name/usr/share/doc/$name/copyright" ]
  if command -v lintian >/dev/null; then
    lintian --fail-on error,warning --tag-display-limit 0 "$deb" || { echo "lintian: $deb"; exit 1; }
  fi
done
ca2=$work/ca2/usr/bin/ca2
commands=$("$ca2" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
for command in $commands; do
  "$ca2" "$command" --help >/dev/null
  # The manual page and the completion know it.
  zcat "$work/ca2/usr/share/man/man1/ca2.1.gz" | grep -q "\"ca2 $command\"" || { echo "ca2(1) lacks $command"; exit 1; }
done
completed=$(PATH=$work/ca2/usr/bin:$PATH bash -c '. "$0"; COMP_WORDS=(ca2 ""); COMP_CWORD=1; _ca2; echo "${COMPREPLY[*]}"' \
  "$work/ca2/usr/share/bash-completion/completions/ca2")
for command in $commands; do
  [[ " $completed " == *" $command "* ]] || { echo "the completion lacks $command"; exit 1; }
done
if command -v mandoc >/dev/null; then
  for page in "$work"/*/usr/share/man/man*/*.gz; do zcat "$page" | mandoc -Tlint -W error; done
fi
if command -v systemd-analyze >/dev/null && [ -d "$work/ca2d" ]; then
  grep -qx /etc/ca2/ca2d.yaml <(dpkg-deb --ctrl-tarfile "$debs"/ca2d_*.deb | tar -xO ./conffiles)
fi
echo "packages: sound"

[ "${CA2_CLEAN_ROOT:-}" = 1 ] || { echo "not installed: CA2_CLEAN_ROOT is not 1"; exit 0; }
[ "$(id -u)" = 0 ] && command -v mmdebstrap >/dev/null || { echo "not installed: no root, or no mmdebstrap"; exit 0; }
root=$work/root
packages=("$debs"/ca2_*.deb)
for deb in "$debs"/ca2d_*.deb; do [ -e "$deb" ] && packages+=("$deb"); done
mmdebstrap --variant=apt --include="$(printf '%s,' "${packages[@]}")bash" \
  --hook-dir=/usr/share/mmdebstrap/hooks/file-mirror-automount bookworm "$root"
mkdir -p "$root/opt/tests/packaging" "$root/opt/docs"
cp "$here/getting_started_test.sh" "$root/opt/tests/packaging/"
cp "$here/../../docs/getting-started.md" "$root/opt/docs/"
for command in $commands; do chroot "$root" ca2 "$command" --help >/dev/null; done
chroot "$root" /opt/tests/packaging/getting_started_test.sh
if [ -e "$root/usr/bin/ca2d" ]; then
  chroot "$root" ca2d --help >/dev/null
  chroot "$root" getent passwd ca2 >/dev/null
  chroot "$root" apt-get purge -yq ca2d >/dev/null
  for left in /etc/ca2 /var/lib/ca2; do [ ! -e "$root$left" ] || { echo "left after the purge: $left"; exit 1; }; done
fi
chroot "$root" apt-get purge -yq ca2 >/dev/null
[ ! -e "$root/usr/bin/ca2" ] && [ ! -e "$root/usr/share/ca2" ]
echo "clean root: installed, tried, purged"
