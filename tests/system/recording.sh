#!/usr/bin/env bash
# Makes the recording that the others play, which a program with sanitizers takes many minutes for.
. "$(dirname "$0")/lib.sh"
recording=$(recording) || fail "$recording"
echo "$recording"
