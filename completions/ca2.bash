# Completion of ca2's commands and options, from what the program says of itself: it cannot fall behind.
_ca2() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]}
  local previous=${COMP_WORDS[COMP_CWORD - 1]} choices
  if [ "$COMP_CWORD" -eq 1 ]; then
    choices=$(ca2 --help 2>/dev/null | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
    mapfile -t COMPREPLY < <(compgen -W "$choices --help --version" -- "$word")
    return
  fi
  # Values that an option lists as {a,b,c}.
  if [[ $previous == -* ]]; then
    choices=$(ca2 "$command" --help 2>/dev/null | sed -n "s/^  \(-[a-z],\)\?$previous [^{]*{\([^}]*\)}.*/\2/p" | tr , ' ')
    if [ -n "$choices" ]; then
      mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
      return
    fi
  fi
  if [[ $word == -* ]]; then
    choices=$(ca2 "$command" --help 2>/dev/null | grep -oE '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+')
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
    return
  fi
  mapfile -t COMPREPLY < <(compgen -f -- "$word")
}
complete -o filenames -F _ca2 ca2
