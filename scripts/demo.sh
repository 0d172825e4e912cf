#!/usr/bin/env bash
# Builds the library and its examples, integrates two mechanical systems with constraints, and draws the solutions.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install-dependencies.sh demo
if command -v ninja > /dev/null; then export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"; fi
export OPENBLAS_NUM_THREADS=1

cmake -S . -B build/demo/cmake -DCMAKE_BUILD_TYPE=Release \
  -DSFDAE_BUILD_TESTS=OFF -DSFDAE_BUILD_FORTRAN=OFF -DSFDAE_BUILD_EXAMPLES=ON
cmake --build build/demo/cmake --parallel "$(nproc)"

cd build/demo
rm -f {constrained_chain,squeezer}.{csv,svg}
cmake/examples/constrained_chain
echo
cmake/examples/squeezer
if command -v gnuplot > /dev/null; then gnuplot ../../examples/squeezer.gp; fi

echo
for file in {constrained_chain,squeezer}.{csv,svg}; do
  if [[ -s "$file" ]]; then
    echo "build/demo/$file"
  else
    # The plots need gnuplot; the first program has said so.
    echo "build/demo/$file was not written" >&2
    if [[ "$file" == *.csv ]]; then exit 1; fi
  fi
done
