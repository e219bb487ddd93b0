# Completion of ca2's commands, options and listed values, from what the program says of itself: it cannot fall behind.
_ca2_subcommands() { sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p' <<<"$1"; }

_ca2() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} place=1 choices help subcommands
  # Down the commands that were written out (`ca2 record cameras`) to the one that the cursor is in.
  local path=()
  while :; do
    help=$(ca2 "${path[@]}" --help 2>/dev/null)
    subcommands=$(_ca2_subcommands "$help")
    [ "$place" -lt "$COMP_CWORD" ] && grep -qxF -- "${COMP_WORDS[place]}" <<<"$subcommands" || break
    path+=("${COMP_WORDS[place]}")
    place=$((place + 1))
  done
  # Values that an option, or what comes in this place, lists as {a,b,c}.
  if [[ $previous == -* ]]; then
    choices=$(sed -n "s/^  \(-[a-z],\)\?$previous [^{]*{\([^}]*\)}.*/\2/p" <<<"$help" | tr , ' ')
  elif [[ $word != -* && $place -eq $COMP_CWORD ]]; then
    choices="$subcommands $(sed -n '/^Positionals:/,/^$/s/^  [a-z]* [^ ]*{\([^}]*\)}.*/\1/p' <<<"$help" | tr , ' ')"
  fi
  if [[ $word == -* ]]; then
    choices=$(grep -oE '^  (-[a-z],)?--[a-z-]+' <<<"$help" | grep -oE -- '--[a-z-]+')
  fi
  if [ -n "${choices// /}" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -o filenames -F _ca2 ca2
