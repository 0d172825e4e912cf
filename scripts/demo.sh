#!/usr/bin/env bash
# Builds the library and its examples, integrates a chain with a closed loop of constraints, and draws the solution.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install-dependencies.sh demo
if command -v ninja > /dev/null; then export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"; fi
export OPENBLAS_NUM_THREADS=1

cmake -S . -B build/demo/cmake -DCMAKE_BUILD_TYPE=Release \
  -DSFDAE_BUILD_TESTS=OFF -DSFDAE_BUILD_FORTRAN=OFF -DSFDAE_BUILD_EXAMPLES=ON
cmake --build build/demo/cmake --parallel "$(nproc)"

cd build/demo
rm -f constrained_chain.csv constrained_chain.svg
cmake/examples/constrained_chain

echo
for file in constrained_chain.csv constrained_chain.svg; do
  if [[ -s "$file" ]]; then
    echo "build/demo/$file"
  else
    # The plot needs gnuplot; the program has said so.
    echo "build/demo/$file was not written" >&2
    if [[ "$file" == *.csv ]]; then exit 1; fi
  fi
done
