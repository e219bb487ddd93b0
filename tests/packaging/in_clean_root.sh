#!/usr/bin/env bash
# What clean_root.sh does inside the bare Debian: install, help, service, the newcomer's manual, purge.
# Never on a machine of yours: it installs and purges. Usage: in_clean_root.sh DIRECTORY_WITH_DEBS
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
debs=$1
export DEBIAN_FRONTEND=noninteractive
# Without recommended packages: what is declared as needed must do.
install() { apt-get install -yq --no-install-recommends "$@" >/tmp/apt.log 2>&1 || { tail -20 /tmp/apt.log; exit 1; }; }
apt-get update -q >/dev/null
# What is there before, less what apt and dpkg write down.
paths() { find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /opt -o -path /var/lib/dpkg -o -path /var/lib/apt -o -path /var/cache -o -path /var/log \) -prune -o -print | sort; }

install "$debs"/ca2_*.deb "$debs"/ca2d_*.deb
echo "clean root: installed, $(dpkg-query -W | wc -l) packages in all"
# Manual pages may be left out by the configuration of a small Debian, and so may documents.
"$here/overview_test.sh" ca2 /usr/share/bash-completion/completions/ca2
ca2 --version
ca2d --help >/dev/null

# The service: the account, its directories, a unit that systemd understands, and a configuration that is judged.
getent passwd ca2 | grep -q ':/var/lib/ca2:'
id -nG ca2 | grep -qw video
[ "$(stat -c '%U:%G %a' /etc/ca2/keys)" = "root:ca2 750" ]
systemd-analyze verify --man=no /usr/lib/systemd/system/ca2d.service
for file in /usr/lib/udev/rules.d/*ca2*.rules /usr/lib/sysctl.d/*ca2*; do [ -s "$file" ]; done
status=0
ca2d --check || status=$?
[ "$status" = 0 ] || [ "$status" = 78 ]
systemctl enable ca2d.service 2>/dev/null

"$here/getting_started_test.sh"
echo "clean root: tried"

if [ "${CA2_CLEAN_ROOT_DEV:-}" = 1 ]; then
  install "$debs"/libca2-dev_*.deb cmake g++ make
  "$here/consumer_test.sh" /usr
  echo "clean root: a program of others built and run"
fi

# An upgrade keeps what the user wrote; a removal keeps sessions; a purge leaves nothing.
mkdir -p /var/lib/ca2/sessions/one
echo '# mine' >>/etc/ca2/ca2d.yaml
apt-get install -yq --reinstall --no-install-recommends "$debs"/ca2d_*.deb >/dev/null
grep -q '^# mine$' /etc/ca2/ca2d.yaml
apt-get remove -yq ca2d >/dev/null
[ -d /var/lib/ca2/sessions/one ] && grep -q '^# mine$' /etc/ca2/ca2d.yaml
[ ! -e /usr/bin/ca2d ]
# shellcheck disable=SC2046
apt-get purge -yq $(dpkg-query -W -f '${Package} ' ca2 ca2d libca2-dev 2>/dev/null) >/tmp/apt.log 2>&1 ||
  { tail -20 /tmp/apt.log; exit 1; }
left=$(paths | grep -E '(^|[^a-z])(lib)?ca2([^a-z]|$|d)' || true)
[ -z "$left" ] || { echo "left after the purge:"; echo "$left"; exit 1; }
if getent passwd ca2 || getent group ca2; then echo "left after the purge: the account"; exit 1; fi
echo "clean root: purged, nothing left"
