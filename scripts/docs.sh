#!/usr/bin/env bash
# Builds the site: guide, theory, reference of C, C++, Fortran and Python. Needs the library for the docstrings of Python.
#
#   scripts/docs.sh             writes build/release/docs/html
#   scripts/docs.sh --open      and shows it
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install-dependencies.sh docs
if command -v ninja > /dev/null; then export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"; fi
cmake --preset release -DSFDAE_BUILD_DOCS=ON > /dev/null
cmake --build build/release --target sfdae_docs --parallel "$(nproc)"
if [[ "${1:-}" == --open ]]; then
  xdg-open build/release/docs/html/index.html
fi
