#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Makes the tarball, installs it with `pkg install` in a folder of its own, and solves a problem with it:
#
#   package_test.sh <octave> <include folder> <folder of libsfdae> <work folder>
set -euo pipefail

octave=$1
include=$2
library=$3
work=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

rm -rf "$work"
mkdir -p "$work/pkgconfig"
cat > "$work/pkgconfig/sfdae.pc" << END
Name: sfdae
Description: the library of this build
Version: 0
libdir=$library
Cflags: -I$include
Libs: -L$library -lsfdae
END
export PKG_CONFIG_PATH="$work/pkgconfig"
tarball=$("$here/../make_package.sh" "$work")

"$octave" --no-gui --no-window-system --quiet --no-init-file --no-history --eval "
  pkg prefix $work/installed $work/installed
  pkg('local_list', '$work/list');
  pkg('install', '$tarball');
  pkg('load', 'sfdae');
  assert(isempty(strfind(which('sfdae_solve'), '$work/installed')), false);
  [T, X] = sfdae_solve(@(t, x, xdot) [0 1; 1 0] * xdot + [x(2); x(1)], [0 1], [1; 2]);
  assert(X(end, :), [1 2] * exp(-1), 1e-5);
  assert(~isempty(strfind(help('sfdae_solve'), 'differentiation index 3')));
  printf('the package is installed and works\n');
  pkg('uninstall', 'sfdae');
"
