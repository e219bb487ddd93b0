#!/usr/bin/env bash
# Holds --help, the manual page and the completion together: every command and subcommand of the program helps, and is
# with every option in the completion and, where the page is given, in ca2(1).
# Usage: overview_test.sh PROGRAM COMPLETION [PAGE.1.gz]
set -euo pipefail
program=$(command -v "$1")
completion=$(realpath "$2")
page=${3:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
# One program, asked once for each help.
cat >"$work/bin/ca2" <<END
#!/bin/sh
kept="$work/\$(echo "\$*" | tr ' /' '__')"
[ -e "\$kept" ] || "$(realpath "$program")" "\$@" >"\$kept" || exit \$?
cat "\$kept"
END
chmod +x "$work/bin/ca2"
PATH=$work/bin:$PATH
# shellcheck disable=SC1090
. "$completion"
fail() { echo "overview: $*"; exit 1; }
offered() {  # offered WORD...: what is offered for the last one
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  COMPREPLY=()
  _ca2
  printf ' %s' "${COMPREPLY[@]}" ' '
}
# As the page is read: roff's escapes undone.
text=
[ -z "$page" ] || text=$(zcat "$page" | sed 's/\\-/-/g; s/\\e/\\/g; s/\\&//g')

count=0
examine() {  # examine [COMMAND [SUBCOMMAND]]
  local help below section options words
  help=$(ca2 "$@" --help) || fail "ca2 $* --help fails"
  options=$(grep -oE '^  (-[a-z],)?--[a-z-]+' <<<"$help" | grep -oE -- '--[a-z-]+')
  words=$(offered ca2 "$@" --)
  for option in $options; do
    [[ $words == *" $option "* ]] || fail "the completion lacks ca2 $* $option"
  done
  if [ $# -gt 0 ] && [ -n "$page" ]; then
    section=$(sed -n "/^\.SS \"ca2 $*\"$/,/^\.fi$/p" <<<"$text")
    [ -n "$section" ] || fail "ca2(1) lacks ca2 $*"
    for option in $options; do
      [[ $section =~ [\ ,]$option[\ $'\n'] ]] || fail "ca2(1) lacks ca2 $* $option"
    done
    [[ $help != *$'\nExample'* || $section == *$'\nExample'* ]] || fail "ca2(1) lacks the examples of ca2 $*"
  fi
  words=$(offered ca2 "$@" "")
  for below in $(sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p' <<<"$help"); do
    [[ $words == *" $below "* ]] || fail "the completion lacks ca2 $* $below"
    count=$((count + 1))
    examine "$@" "$below"
  done
}
examine
[ "$count" -ge 30 ] || fail "only $count commands were found"
[[ $(offered ca2 auto "") == *" on "* ]] || fail "ca2 auto on is not completed"
[[ $(offered ca2 export --format u) == *" urdf "* ]] || fail "ca2 export --format urdf is not completed"
[[ $(offered ca2 so) == " solve "* ]] || fail "ca2 so is not completed"
if [ -n "$page" ] && command -v mandoc >/dev/null; then zcat "$page" | mandoc -Tlint -W error; fi
echo "overview: $count commands agree"
