#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Makes the package for Octave, sfdae-<version>.tar.gz:
#
#   octave/make_package.sh [<folder>]     default: the current folder
#
# Install it with `pkg install sfdae-<version>.tar.gz` in Octave. pkg-config has to find the library sfdae then.
set -euo pipefail

source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
target=$(cd "${1:-.}" && pwd)
header="$source/../include/sfdae/sfdae.h"
version=$(sed -n 's/^#define SFDAE_VERSION_\(MAJOR\|MINOR\|PATCH\) \([0-9]*\)$/\2/p' "$header" | paste -sd.)
declared=$(sed -n 's/^Version: //p' "$source/DESCRIPTION")
if [[ "$version" != "$declared" ]]; then
  echo "make_package.sh: DESCRIPTION has version $declared, the library has $version: correct DESCRIPTION" >&2
  exit 1
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
package="$work/sfdae-$version"
mkdir -p "$package/src"
cp "$source/DESCRIPTION" "$source/COPYING" "$source/INDEX" "$package"
cp -R "$source/inst" "$package"
cp "$source"/src/*.c "$source"/src/*.h "$source/src/Makefile" "$package/src"
mkdir -p "$package/doc"
cp "$source"/examples/*.m "$package/doc"
tar -C "$work" --owner=0 --group=0 --sort=name -czf "$target/sfdae-$version.tar.gz" "sfdae-$version"
echo "$target/sfdae-$version.tar.gz"
