#!/usr/bin/env bash
# processor_time.sh <name> <command>...: runs a command and adds a line "<seconds of processor time> <name>" to
# $SFDAE_TEST_TIMES. Signals that end the command are passed on as 128 plus their number.
name="$1"
shift
exec 3>&1 4>&2
TIMEFORMAT='%U %S'
used="$({ time "$@" 1>&3 2>&4 3>&- 4>&-; } 2>&1)"
status=$?
awk -v name="$name" '{ printf "%.2f %s\n", $1 + $2, name }' <<< "${used//,/.}" >> "$SFDAE_TEST_TIMES"
exit $status
