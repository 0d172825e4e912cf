#!/usr/bin/env bash
# Fails if a line of C, C++ or Fortran has more than 120 columns, comments included.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folders=(include src fortran_bindings python cli examples tests benchmarks)
long=$(LC_ALL=C.UTF-8 grep -rnE '^.{121,}' "${folders[@]}" \
  --include='*.h' --include='*.hpp' --include='*.c' --include='*.cpp' --include='*.f' --include='*.f90' || true)
if [ -n "$long" ]; then
  printf '%s\n' "$long"
  echo "FAILED: $(wc -l <<<"$long") lines have more than 120 columns"
  exit 1
fi
echo "no line has more than 120 columns"
