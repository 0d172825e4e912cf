#!/usr/bin/env bash
# Installs what is missing on Debian or Ubuntu:
#
#   scripts/install-dependencies.sh demo    to build the library and run the demonstration
#   scripts/install-dependencies.sh docs    to build the documentation
#   scripts/install-dependencies.sh program to build the program sfdae
#   scripts/install-dependencies.sh python  to install the Python package with pip
#   scripts/install-dependencies.sh octave  to build the package for Octave
#   scripts/install-dependencies.sh package to make Debian packages
#   scripts/install-dependencies.sh test    for scripts/test.sh
#   scripts/install-dependencies.sh all     for scripts/test.sh --all (default)
#
# A second argument --list prints what is missing and installs nothing. If nothing is missing, it says nothing and
# needs neither network nor root.
set -euo pipefail

demo=(build-essential g++ cmake pkg-config libopenblas-dev libblas-dev liblapack-dev gnuplot-nox)
python_module=(python3-dev python3-cffi python3-numpy)
python_build=("${python_module[@]}" python3-setuptools python3-wheel)
python=("${demo[@]}" "${python_build[@]}" python3-matplotlib python3-pip)
site=(doxygen python3-sphinx python3-myst-parser python3-breathe furo)
docs=("${demo[@]}" "${python_module[@]}" "${site[@]}")
program=("${demo[@]}" libcli11-dev nlohmann-json3-dev)
octave=("${demo[@]}" octave octave-dev)
# With the reference BLAS alone: packages depend on any BLAS.
package=(g++ cmake ninja-build dpkg-dev file gzip libblas-dev liblapack-dev libcli11-dev nlohmann-json3-dev
  "${python_build[@]}" "${site[@]}")
test=("${demo[@]}" gfortran libgtest-dev libsuitesparse-dev libcli11-dev nlohmann-json3-dev python3 ninja-build
  "${python[@]}" python3-pytest mypy python3-tqdm python3-pandas python3-nbconvert python3-ipykernel
  "${site[@]}" chromium chromium-driver python3-selenium)
all=("${test[@]}" "${octave[@]}" libbenchmark-dev valgrind clang clang-format-14)
# For an example of MPI, and tests of executors: installed with others that are missing, never alone, as nothing else
# needs them. Tests of sfdae.torch run if python3-torch, which takes 500 MB, is there.
welcome=(libopenmpi-dev openmpi-bin python3-distributed python3-mpi4py)

case "${1:-all}" in
  demo) wanted=("${demo[@]}") ;;
  docs) wanted=("${docs[@]}") ;;
  program) wanted=("${program[@]}") ;;
  python) wanted=("${python[@]}" python3-venv) ;;
  octave) wanted=("${octave[@]}") ;;
  package) wanted=("${package[@]}") ;;
  test) wanted=("${test[@]}") ;;
  all) wanted=("${all[@]}") ;;
  *)
    echo "usage: $0 [demo|docs|program|python|octave|package|test|all] [--list]" >&2
    exit 2
    ;;
esac

# A program counts as present wherever it comes from; a library if its package is installed.
is_present() {
  case "$1" in
    g++ | cmake | pkg-config | gfortran | valgrind | python3 | clang) command -v "$1" > /dev/null ;;
    ninja-build) command -v ninja > /dev/null ;;
    clang-format-14) command -v clang-format-14 > /dev/null || command -v clang-format > /dev/null ;;
    gnuplot-nox) command -v gnuplot > /dev/null ;;
    *) [[ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2> /dev/null)" == installed ]] ;;
  esac
}

missing=()
if command -v dpkg-query > /dev/null; then
  for package in "${wanted[@]}"; do
    is_present "$package" || missing+=("$package")
  done
  # Valgrind needs the symbols of the C library.
  if [[ " ${missing[*]} " == *" valgrind "* ]]; then missing+=(libc6-dbg); fi
else
  echo "This is neither Debian nor Ubuntu: make sure that there are a C++20 compiler, CMake and LAPACK." >&2
fi
if [[ ${#missing[@]} -eq 0 ]]; then
  exit 0
fi

if [[ "${1:-all}" == test || "${1:-all}" == all ]]; then
  for package in "${welcome[@]}"; do
    is_present "$package" || missing+=("$package")
  done
fi
if [[ "${2:-}" == --list ]]; then
  echo "${missing[*]}"
  exit 0
fi
echo "Installing ${missing[*]}"
as_root=()
if [[ "$(id -u)" -ne 0 ]]; then
  if ! command -v sudo > /dev/null; then
    echo "Missing packages and neither root nor sudo: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update
# Where there is no clang-format-14, any clang-format: scripts/test.sh checks with version 14 only.
if ! apt-cache show clang-format-14 > /dev/null 2>&1; then
  missing=("${missing[@]/#clang-format-14/clang-format}")
fi
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
