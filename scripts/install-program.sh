#!/usr/bin/env bash
# Builds the program sfdae and installs it for this user, or for all where that is allowed:
#
#   scripts/install-program.sh               to ~/.local
#   scripts/install-program.sh /usr/local    elsewhere
#
# Installs what is missing on Debian or Ubuntu. The build stays in build/program.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
prefix="${1:-$HOME/.local}"

scripts/install-dependencies.sh program
if command -v ninja > /dev/null; then export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"; fi
# Only the program and the library that it needs: somebody waits for them.
cmake -S . -B build/program -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG" \
  -DSFDAE_BUILD_PROGRAM=ON -DSFDAE_BUILD_FORTRAN=OFF > /dev/null
cmake --build build/program --parallel "$(nproc)" --target sfdae_program
for component in runtime program; do
  cmake --install build/program --prefix "$prefix" --component "$component" > /dev/null
done

program="$prefix/bin/sfdae"
"$program" --version
if [[ "$(command -v sfdae || true)" != "$program" ]]; then
  echo "Its path is $program; to call it by its name: PATH=\"$prefix/bin:\$PATH\""
else
  program=sfdae
fi
printf '\nTry:\n  %s solve examples/models/crane.mo --html crane.html --show\n' "$program"
