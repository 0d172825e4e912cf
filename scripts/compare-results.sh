#!/bin/sh
# Runs whose results differ between two revisions, bit by bit, by benchmarks/result_hashes.cpp of each of them.
#
#   scripts/compare-results.sh BEFORE AFTER [WORDS]
#
# WORDS: file of lines `old => new`, words that are replaced in messages of both revisions. The exit code is 1 if
# anything differs. Worktrees and programs are kept below build/compare-results/ until the next comparison.
set -eu
if [ $# -lt 2 ] || [ $# -gt 3 ]; then
  sed -n '2,7s/^# \{0,1\}//p' "$0"
  exit 2
fi
root=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)
words=${3:+$(realpath "$3")}
place=$root/build/compare-results
export OPENBLAS_NUM_THREADS=1
mkdir -p "$place"

# hashes SIDE REVISION: writes SIDE.txt
hashes() {
  tree=$place/$1
  revision=$(git -C "$root" rev-parse --verify "$2^{commit}")
  if [ -e "$tree/.git" ]; then
    git -C "$tree" checkout --quiet --force --detach "$revision"
  else
    git -C "$root" worktree prune
    git -C "$root" worktree add --quiet --force --detach "$tree" "$revision"
  fi
  cmake -S "$tree" -B "$place/$1-build" -DCMAKE_BUILD_TYPE=Release -DSFDAE_BUILD_BENCHMARKS=ON \
    -DSFDAE_BUILD_TESTS=OFF -DSFDAE_BUILD_EXAMPLES=OFF -DSFDAE_BUILD_FORTRAN=OFF >"$place/$1.log"
  cmake --build "$place/$1-build" --target benchmark_result_hashes --parallel >>"$place/$1.log" || {
    cat "$place/$1.log" >&2
    exit 2
  }
  "$place/$1-build/benchmarks/result_hashes" ${words:+--words "$words"} >"$place/$1.txt"
}

hashes before "$1"
hashes after "$2"
if cmp -s "$place/before.txt" "$place/after.txt"; then
  echo "all $(wc -l <"$place/after.txt") runs agree"
  exit 0
fi
awk 'NR == FNR { before[$1] = $2; next }
     !($1 in before) { print $1 " (not in the first revision)"; next }
     before[$1] != $2 { print $1 }
     { delete before[$1] }
     END { for (name in before) print name " (not in the second revision)" }' "$place/before.txt" "$place/after.txt"
echo "Details: $place/before-build/benchmarks/result_hashes --text NAME, and after-build" >&2
exit 1
