#!/bin/sh
# ca2(1) from what the program says of itself: man-page.sh PROGRAM OUTPUT.1.gz
set -eu
program=$1
output=$2
mkdir -p "$(dirname "$output")"

# Text as roff shows it: backslashes, and lines that would begin a request.
roff() { sed -e 's/\\/\\e/g' -e "s/^\([.']\)/\\\\\&\1/" -e 's/-/\\-/g'; }
# subcommands [COMMAND]
subcommands() { "$program" "$@" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p'; }
# section COMMAND [SUBCOMMAND]: and those below it. The exit statuses have a section of their own.
section() {
  printf '.SS "ca2 %s"\n.nf\n' "$*"
  "$program" "$@" --help | sed '/^Exit status:/,/^$/d' | roff
  printf '.fi\n'
  for below in $(subcommands "$@"); do section "$@" "$below"; done
}
commands=$(subcommands)
[ -n "$commands" ]

{
  printf '.TH CA2 1 "2026-11-22" "%s" "User Commands"\n' "$("$program" --version)"
  printf '.SH NAME\nca2 \\- calibrates LiDARs and cameras with a printed board\n'
  printf '.SH SYNOPSIS\n.B ca2\n.I COMMAND\n[OPTIONS]\n'
  printf '.SH DESCRIPTION\nFinds where each LiDAR of a robot sits relative to each camera from a few views of a printed board.\n'
  printf 'The manuals are in /usr/share/doc/ca2; begin with getting-started.md.\n'
  printf '.SH COMMANDS\n'
  for command in $commands; do section "$command"; done
  printf '.SH EXIT STATUS\n0 done; 1 refused, no result is written; 64 usage; 65 bad data; 69 unavailable;\n'
  printf '70 a bug; 73 cannot create; 74 input or output; 77 not permitted; 78 bad configuration.\n'
  printf '.SH SEE ALSO\n.BR ca2d (8),\n.BR ca2d.yaml (5),\n.BR ca2-session (5)\n'
} | gzip -9n >"$output"
