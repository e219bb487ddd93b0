#!/usr/bin/env bash
# Holds the manuals to what they speak of: every option of the daemon is in ca2d.yaml(5) with its meaning and default, every
# LiDAR model and camera driver in the list of sensors, the pictures are what their script draws, links lead somewhere, and
# what lists the commands that there are names no others.
# Usage: manuals_test.sh PROGRAM_CA2 PROGRAM_CA2D
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
ca2=$1
ca2d=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0
complain() { echo "manuals: $*"; status=1; }

# As it is read: macros and line breaks gone.
page=$(sed 's/^\.Xr \([a-z0-9]*\) [0-9].*/`\1`/; s/^\.It Ic \([a-z]*\) \. Ns Ic /@\1./; s/^\.[A-Z][a-z] //' "$top/docs/man/ca2d.yaml.5" | tr '\n' ' ')
section=
count=0
while IFS= read -r line; do
  if [[ $line =~ ^([a-z]+):$ ]]; then
    section=${BASH_REMATCH[1]}
  elif [[ $line =~ ^\ \ ([a-z_]+):\ (.*[^\ ])\ +#\ (.*)$ ]]; then
    key="@$section.${BASH_REMATCH[1]} " default=${BASH_REMATCH[2]//\"/} meaning=${BASH_REMATCH[3]% (restart)}
    entry=${page#*"$key"}
    [ "$entry" != "$page" ] || { complain "ca2d.yaml(5) lacks ${key#@}"; continue; }
    entry=${entry%%@*}
    # The meaning's words up to its first comma or semicolon: limits may follow in between.
    [[ $entry == *"${meaning%%[,;]*}"* ]] || complain "ca2d.yaml(5), ${key#@}: not '$meaning'"
    [[ $entry == *"; $default"* ]] || complain "ca2d.yaml(5), ${key#@}: the default is not $default"
    count=$((count + 1))
  fi
done < <("$ca2d" --config "$top/config/ca2d.yaml" --print-config)
[ "$count" -ge 14 ] || complain "only $count options were compared"

sensors=$(cat "$top/docs/supported-sensors.md")
for model in $("$ca2" decode --model none --output "$work/none" /dev/null 2>&1 | sed -n 's/.*known models: //p' | tr -d ,); do
  [[ $sensors =~ [\ ,\(\`]$model[\ ,\;\`] ]] || complain "supported-sensors.md lacks $model"
done
for driver in $("$ca2" snap --help | sed -n 's/^  \([a-z0-9_]*\): .*/\1/p'); do
  [[ $sensors == *"\`$driver\`"* ]] || complain "supported-sensors.md lacks $driver"
done

"$top/tools/doc-pictures.sh" "$work/images"
for picture in "$work"/images/*; do
  cmp "$picture" "$top/docs/images/${picture##*/}" || complain "make it again: tools/doc-pictures.sh docs/images"
done

commands=$("$ca2" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
while IFS=: read -r file link; do
  [ -e "$top/${file%/*}/$link" ] || complain "$file: broken link $link"
done < <(cd "$top" && grep -oE '\]\([a-zA-Z0-9/_.-]+' -- README.md docs/*.md | sed 's/](//; s#^README#./README#')
while IFS=: read -r file command; do
  grep -qx "${command#ca2 }" <<<"$commands" || complain "$file: there is no $command"
done < <(cd "$top" && grep -oE '`ca2 [a-z]+' -- README.md docs/*.md | tr -d '`' | sort -u)

if command -v mandoc >/dev/null; then
  for page in "$top"/docs/man/*; do mandoc -Tlint -W warning "$page" || complain "mandoc: $page"; done
fi
[ "$status" = 0 ] && echo "manuals: true, $count options"
exit "$status"
