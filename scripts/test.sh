#!/usr/bin/env bash
# Builds and tests, on two cores:
#
#   scripts/test.sh            library, program, tests and examples in build/release; all tests that are not long, with
#                              OpenBLAS: 10 minutes at most
#   scripts/test.sh --memory   the same, then sanitizers on the tests of what owns memory: 20 minutes
#   scripts/test.sh --all      everything: an hour and a half
#
# --all adds
#
#   format       all C and C++ sources are as clang-format 14 writes them
#   release      long tests, too, and benchmarks are compiled
#   traps        the C++ and Fortran 77 tests of the same build, small, with the reference BLAS and LAPACK, where
#                floating-point exceptions end the program
#   valgrind     some examples in C and Fortran 77
#   asan         address and undefined behavior sanitizers, by Clang if it is there, very small, without long tests,
#                tests of the tests, and without what links programs of other compilers to this build: the guide,
#                symbols, installation
#
# The number of random problems and of similar cases is reduced, to 0.1 of all in the phase release; SFDAE_TEST_SCALE
# chooses another part, 1 is all. "Small" is a quarter of that, "very small" a tenth. SFDAE_WERROR=ON makes warnings
# errors.
# Tests that need more than 5 seconds of processor time are listed; more than 15 seconds are a failure without --all:
# such a test has to become faster, or to be labelled long. On slow processors the limit is higher (limit_of_times).
# A test that takes longer than four times the build is ended, but none before a quarter of an hour.
# At the end stands how long each phase took; the last line is "N passed, M failed".
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root="$PWD"

mode="${1:-}"
case "$mode" in
  '') packages=test plan="all tests that are not long: 10 minutes" ;;
  --memory) packages=all plan="all tests that are not long; sanitizers on what owns memory: 20 minutes" ;;
  --all) packages=all plan="all tests, a second BLAS, valgrind, sanitizers: an hour and a half" ;;
  *)
    echo "usage: $0 [--memory|--all]" >&2
    exit 2
    ;;
esac
echo "Builds the library, the program, tests and examples in build/release; then $plan on two cores."
missing="$(scripts/install-dependencies.sh "$packages" --list)"
echo "Packages to be installed: ${missing:-none}."

passed=0
failed=0
finish() {
  local status=$?
  # What ends this script early, such as a build that fails, counts as one failure.
  if [[ $status -ne 0 ]]; then complain "ended early"; fi
  end_phase
  print_times
  echo "$passed passed, $failed failed"
  exit $((failed > 0))
}
trap finish EXIT
# A signal is a failure, too; what runs at the time is waited for.
for signal in HUP INT TERM; do trap "exit 1" "$signal"; done

phase='' phase_start=0 phase_processor=0
phase_times=() # lines "<wall> <processor> <phase>", in seconds
heading() {
  end_phase
  phase="$1" phase_start=$SECONDS phase_processor="$(processor_seconds)"
  printf '\n==== %s (%d s)\n' "$phase" "$SECONDS"
}
end_phase() {
  if [[ -n "$phase" ]]; then
    phase_times+=("$((SECONDS - phase_start)) $(($(processor_seconds) - phase_processor)) $phase")
  fi
  phase=''
}
# Of the processes that this script has waited for: fields 16 and 17 of its status, after a name in parentheses.
processor_seconds() {
  local status fields
  if ! { status="$(< "/proc/$$/stat")"; } 2> /dev/null; then echo 0 && return; fi
  read -r -a fields <<< "${status##*) }"
  echo $(((fields[13] + fields[14]) / $(getconf CLK_TCK)))
}
print_times() {
  printf '\n   wall  processor  (minutes)\n'
  { printf '%s\n' "${phase_times[@]}"; } | awk 'NF { wall = $1; processor = $2; $1 = $2 = ""
    printf "%7.1f %10.1f %s\n", wall / 60, processor / 60, $0; walls += wall; processors += processor }
    END { printf "%7.1f %10.1f  in all\n", walls / 60, processors / 60 }'
}
complain() {
  echo "FAILED: $1"
  failed=$((failed + 1))
}

# run_tests <name> <preset> [ctest options]: runs ctest and adds to the sums what its report says.
run_tests() {
  local name="$1" preset="$2"
  shift 2
  local report="$root/build/reports/$name.xml" status=0 header total lost
  rm -f "$report"
  export SFDAE_TEST_TIMES="$root/build/reports/$name.times"
  rm -f "$SFDAE_TEST_TIMES"
  ctest --preset "$preset" --timeout "$timeout" --output-junit "$report" "$@" || status=$?
  if [[ ! -s "$report" ]]; then
    complain "$name: ctest wrote no report"
    return
  fi
  header="$(tr '\n\t' '  ' < "$report" | grep -o '<testsuite [^>]*>')"
  total="$(attribute tests "$header")"
  # A program that is missing is reported as skipped; no test is skipped on purpose.
  lost=$(($(attribute failures "$header") + $(attribute skipped "$header")))
  passed=$((passed + total - lost))
  failed=$((failed + lost))
  if [[ $status -ne 0 && $lost -eq 0 ]]; then complain "$name: ctest returned $status"; fi
}
# build <preset>: builds, and derives the time limit of tests from how long that took.
timeout=900
build() {
  local start=$SECONDS
  cmake --build --preset "$1" || return
  timeout=$((4 * (SECONDS - start)))
  if [[ $timeout -lt 900 ]]; then timeout=900; fi
}
# time_alone <preset> <test>: seconds of processor time of a test when nothing else runs.
time_alone() {
  local times="$root/build/reports/alone.times"
  rm -f "$times"
  SFDAE_TEST_TIMES="$times" ctest --preset "$1" -R "^${2//./\\.}\$" > /dev/null || true
  awk '{ print $1 }' "$times"
}
# limit_of_times: 15 seconds, or more on a processor that is slower than the one where a loop of awk takes 0.45 seconds
# (measured: shared machines are up to twice as slow at times).
limit_of_times() {
  local TIMEFORMAT=%U
  { time awk 'BEGIN { for (i = 0; i < 2e7; ++i) s += i * i }'; } 2>&1 |
    awk '{ limit = 15 * $1 / 0.45; print int(limit > 15 ? limit : 15) }'
}
# judge_times <preset>: lists tests by their processor time; without --all too long ones are failures. Two tests that
# share a core take up to twice as long, so that those are measured again.
judge_times() {
  local seconds entry limit
  printf '\nProcessor time above 5 seconds:\n'
  while read -r seconds entry; do
    printf '%8.1f  %s\n' "$seconds" "$entry"
    if [[ "$mode" == --all || "${seconds%.*}" -lt 15 ]]; then continue; fi
    seconds="$(time_alone "$1" "$entry")"
    limit="$(limit_of_times)"
    printf '%8.1f  %s, alone; the limit is %d\n' "$seconds" "$entry" "$limit"
    if [[ "${seconds%.*}" -ge "$limit" ]]; then
      complain "$entry needs more than $limit seconds of processor time: make it faster or label it long"
    fi
  done < <(sort -rn "$root/build/reports/$1.times" | awk '$1 > 5')
}
attribute() { sed -E "s/.* $1=\"([0-9]+)\".*/\1/" <<< "$2"; }

# Directories of the BLAS and LAPACK that the given packages contain, as a search path.
library_path() {
  local path='' library dir
  for library in libblas.so.3 liblapack.so.3; do
    dir="$(dpkg -L "$@" 2> /dev/null | grep -m 1 "/$library\$" | xargs -r dirname)"
    [[ -n "$dir" ]] || return 1
    path="$path${path:+:}$dir"
  done
  echo "$path"
}
openblas_packages() { dpkg-query -W -f '${db:Status-Status} ${Package}\n' 'libopenblas0-*' | sed -n 's/^installed //p'; }

# check_loaded <name> <search path>: with this path the library and the C++ tests load BLAS and LAPACK from there.
check_loaded() {
  local binary library loaded dirs=":$2:"
  for binary in build/release/src/libsfdae.so build/release/tests/*_test; do
    for library in libblas.so.3 liblapack.so.3; do
      loaded="$(LD_LIBRARY_PATH="$2" ldd "$binary" | sed -n "s|.*$library => \([^ ]*\) .*|\1|p")"
      # C programs have them from libsfdae; a C++ test may need only one of them.
      if [[ -n "$loaded" && "$dirs" != *":$(dirname "$loaded"):"* ]] ||
        [[ -z "$loaded" && "$binary" == *.so ]]; then
        complain "$1: $binary loads $library from '$loaded', not from $2"
        return
      fi
    done
  done
  echo "BLAS and LAPACK from $2"
}

heading "dependencies"
scripts/install-dependencies.sh "$packages"
if command -v ninja > /dev/null; then export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"; fi
export OPENBLAS_NUM_THREADS=1
unset SFDAE_TEST_FPE_TRAPS
scale="${SFDAE_TEST_SCALE:-0.1}"
part_of_scale() { awk -v scale="$scale" -v part="$1" 'BEGIN { print scale / part }'; }
small="$(part_of_scale 4)"
very_small="$(part_of_scale 10)"
mkdir -p build/reports

mapfile -t openblas_names < <(openblas_packages)
openblas="$(library_path "${openblas_names[@]}")" || { echo "OpenBLAS was not found"; exit 1; }

check_format() {
  heading "format: C and C++ sources"
  # Versions of clang-format differ in what they write.
  clang_format="$(command -v clang-format-14 || command -v clang-format || true)"
  if [[ -z "$clang_format" ]]; then
    echo "clang-format is not installed: skipped"
  elif [[ "$("$clang_format" --version)" != *" version 14."* ]]; then
    echo "$("$clang_format" --version) is not version 14: skipped"
  elif ! git rev-parse --is-inside-work-tree > /dev/null 2>&1; then
    echo "this is no checkout of git, which lists the sources: skipped"
  elif git ls-files -z -- '*.c' '*.h' '*.cpp' '*.hpp' | xargs -0 "$clang_format" --dry-run -Werror; then
    echo "all are formatted"
    passed=$((passed + 1))
  else
    complain "format: run $clang_format -i on the files named above"
  fi
}

build_release() {
  heading "release: build"
  # All sources of a folder at once and a dozen tests at once: a third of the time. That each includes what it uses is what
  # scripts/check-included-names.py looks at. Benchmarks are compiled, not run.
  cmake --preset release -DSFDAE_WERROR="${SFDAE_WERROR:-OFF}" -DSFDAE_BENCHMARK_OPTIONS=-O0 -DSFDAE_BUILD_BENCHMARKS="$1"
  build release
}

test_release() {
  heading "release: tests, OpenBLAS, $scale of random problems"
  check_loaded release "$openblas"
  LD_LIBRARY_PATH="$openblas" SFDAE_TEST_SCALE="$scale" run_tests release release "$@"
  LD_LIBRARY_PATH="$openblas" SFDAE_TEST_SCALE="$scale" judge_times release
}

test_traps() {
  heading "traps: C++ and Fortran 77 tests, reference BLAS, floating-point exceptions"
  check_loaded traps "$reference"
  LD_LIBRARY_PATH="$reference" SFDAE_TEST_FPE_TRAPS=1 SFDAE_TEST_SCALE="$small" run_tests traps release -L '^(unit|f77)$'
}

# The kernels of OpenBLAS read past the ends of arrays, harmlessly; the reference BLAS does not.
check_with_valgrind() {
  heading "valgrind: examples"
  if ! command -v valgrind > /dev/null; then
    echo "valgrind is not installed: skipped"
  elif ! valgrind --quiet true; then
    echo "valgrind does not work here (is libc6-dbg missing?): skipped"
  else
    mkdir -p build/reports/valgrind
    for program in gelda_document underdetermined checkpoint pendulum robot_arm dgelda; do
      if (cd build/reports/valgrind && LD_LIBRARY_PATH="$reference" valgrind --quiet --leak-check=full \
        --error-exitcode=99 "$root/build/release/examples/$program" > "$program.txt"); then
        echo "$program: no errors, no leaks"
        passed=$((passed + 1))
      else
        complain "valgrind $program"
      fi
    done
  fi
}

# test_with_sanitizers <tests>: SFDAE_TESTS.
test_with_sanitizers() {
  heading "asan: build"
  # Clang needs half the time for that. Its warnings are shown only: they are others than GCC's.
  local options=(-DSFDAE_UNITY_TESTS=ON -DSFDAE_TESTS="$1")
  if [[ "$1" == memory ]]; then options+=(-DSFDAE_BUILD_EXAMPLES=OFF); else options+=(-DSFDAE_BUILD_EXAMPLES=ON); fi
  if command -v clang > /dev/null && command -v clang++ > /dev/null; then
    options+=(-DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DSFDAE_WERROR=OFF)
  fi
  cmake --preset asan "${options[@]}"
  if ! build asan; then
    echo "Clang could not build this, see above: once more with the default compiler"
    rm -rf build/asan
    cmake --preset asan -DSFDAE_TESTS="$1"
    build asan
  fi

  heading "asan: tests"
  LD_LIBRARY_PATH="$openblas" SFDAE_TEST_SCALE="$very_small" run_tests asan asan
}

if [[ "$mode" == --all ]]; then
  reference="$(library_path libblas3 liblapack3)" || { echo "The reference BLAS was not found"; exit 1; }
  check_format
  build_release ON
  test_release
  test_traps
  check_with_valgrind
  test_with_sanitizers sanitized
else
  build_release OFF
  test_release -LE '^long$'
  if [[ "$mode" == --memory ]]; then test_with_sanitizers memory; fi
fi
