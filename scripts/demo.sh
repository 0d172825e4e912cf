#!/usr/bin/env bash
# Builds the library and two of its examples, integrates two mechanical systems with constraints, and draws the solutions.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install-dependencies.sh demo
if command -v ninja > /dev/null; then export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"; fi
export OPENBLAS_NUM_THREADS=1

# Only the library and the two examples: somebody waits for them.
cmake -S . -B build/demo/cmake -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG" \
  -DSFDAE_BUILD_FORTRAN=OFF -DSFDAE_BUILD_PROGRAM=OFF -DSFDAE_BUILD_EXAMPLES=ON
cmake --build build/demo/cmake --parallel "$(nproc)" --target example_constrained_chain example_squeezer

cd build/demo
rm -f {constrained_chain,squeezer}.{csv,svg}
cmake/examples/constrained_chain
echo
cmake/examples/squeezer
if command -v gnuplot > /dev/null; then
  for plot in constrained_chain squeezer; do gnuplot "../../examples/$plot.gp"; done
fi

echo
for file in {constrained_chain,squeezer}.{csv,svg}; do
  if [[ -s "$file" ]]; then
    echo "build/demo/$file"
  else
    echo "build/demo/$file was not written (plots need gnuplot)" >&2
    if [[ "$file" == *.csv ]]; then exit 1; fi
  fi
done

cat << 'END'

Four things to try:

  all examples, checked    cmake --build build/demo/cmake --parallel && ctest --test-dir build/demo/cmake --output-on-failure
  a program of your own    cp examples/pendulum.c my_problem.c; edit it; then
                           cc my_problem.c -Iinclude -Lbuild/demo/cmake/src -lsfdae -lm \
                             -Wl,-rpath,$PWD/build/demo/cmake/src -o my_problem && ./my_problem
  in Python                scripts/install-dependencies.sh python
                           python3 -m venv --system-site-packages build/venv
                           build/venv/bin/pip install --no-build-isolation ./python
                           build/venv/bin/python python/examples/pendulum_chain.py
  a model in a file        scripts/install-program.sh
                           ~/.local/bin/sfdae solve examples/models/pendulum.mo --html pendulum.html
END
