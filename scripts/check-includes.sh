#!/usr/bin/env bash
# Fails if an #include runs upward: folders of src/ know the ones below them only.
#
#   linalg < expression < structure < problem < reduction < system < starts < linear < array < extension
#          < multibody < watch < sensitivity < integrate < solver < hybrid < ensemble < c_api
#
# fortran_bindings/f77 is a second front end beside c_api: it may use all folders below. The public headers
# (sfdae/...) have no folder of src/ below them. The program in cli/ uses the public headers only:
#
#   model < modelica, simulation < program
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

awk '
  BEGIN {
    count = split("linalg expression structure problem reduction system starts linear array extension " \
                  "multibody watch sensitivity integrate solver hybrid ensemble c_api", order)
    for (i = 1; i <= count; ++i) height[order[i]] = i
    height["f77"] = height["c_api"]
    height["sfdae"] = 0
    first_of_cli = 100
    height["model"] = first_of_cli
    height["modelica"] = height["simulation"] = first_of_cli + 1
    height["program"] = first_of_cli + 2
  }
  FNR == 1 {
    folder = FILENAME
    sub(/^(src|fortran_bindings|cli)\//, "", folder)
    sub(/\/.*/, "", folder)
    if (!(folder in height)) complain("a folder without a place in the order")
  }
  /^[ \t]*#[ \t]*include[ \t]*"/ {
    split($0, parts, "\"")
    used = parts[2]
    if (!sub(/\/.*/, "", used)) next  # beside the file
    ++includes
    if (!(used in height)) complain("unknown folder")
    else if (used != folder && height[used] >= height[folder]) complain(folder " must not use " used)
    else if (height[folder] >= first_of_cli && height[used] < first_of_cli && used != "sfdae")
      complain("the program must not use " used)
  }
  function complain(what) {
    print FILENAME ":" FNR ": " $0 ": " what
    ++failed
  }
  END {
    if (!failed) print includes " includes, none runs upward"
    exit failed > 0
  }' $(find src fortran_bindings/f77 cli -name '*.h' -o -name '*.cpp' | sort)
