#!/usr/bin/env bash
# Builds the Debian packages and the source distribution for Python in a Debian of its own, installs them in another one
# that is clean, and uses them there:
#
#   scripts/test-packages.sh [SUITE]         bookworm, trixie, ...; default: that of this machine
#   scripts/test-packages.sh SUITE tests     and builds all tests there, and runs those that are not long
#
# Warnings are errors, so that this also tests the compiler of that Debian. It needs root, debootstrap and a mirror of
# Debian, and some 3 GB. SFDAE_ROOTS=<folder> keeps both systems there for the next time. Packages are left in
# build/packages/SUITE.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
suite="${1:-$(. /etc/os-release && echo "$VERSION_CODENAME")}"
mirror="${SFDAE_DEBIAN_MIRROR:-http://deb.debian.org/debian}"
packages="$PWD/build/packages/$suite"
jobs="$(nproc)"

if [[ "$(id -u)" -ne 0 ]] || ! command -v debootstrap > /dev/null; then
  echo "This needs root and debootstrap" >&2
  exit 2
fi
roots="${SFDAE_ROOTS:-$(mktemp -d)}"
builder="$roots/$suite-build" clean="$roots/$suite-clean"
finish() {
  local status=$?
  for root in "$builder" "$clean"; do
    for folder in dev/pts proc; do
      if mountpoint -q "$root/$folder"; then umount "$root/$folder"; fi
    done
  done
  if [[ -z "${SFDAE_ROOTS:-}" ]]; then rm -rf --one-file-system "$roots"; fi
  if [[ $status -eq 0 ]]; then echo "PASSED"; else echo "FAILED"; fi
}
trap finish EXIT
for signal in HUP INT TERM; do trap "exit 1" "$signal"; done

heading() { printf '\n==== %s (%d s)\n' "$1" "$SECONDS"; }
# inside <root> <command>...: without variables of this machine but those of proxies.
inside() {
  local root="$1"
  shift
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
  # Terminals of its own, for tests of progress bars.
  mountpoint -q "$root/dev/pts" || mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    OPENBLAS_NUM_THREADS=1 http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" chroot "$root" "$@"
}
install_in() {
  local root="$1"
  shift
  inside "$root" apt-get install -q -y --no-install-recommends "$@"
}

heading "two systems: $suite"
if [[ ! -e "$roots/$suite.tar" ]]; then
  debootstrap --variant=minbase "$suite" "$roots/$suite-base" "$mirror"
  tar -C "$roots/$suite-base" -cf "$roots/$suite.tar" .
  rm -rf --one-file-system "$roots/$suite-base"
fi
rm -rf --one-file-system "$clean"
for root in "$builder" "$clean"; do
  if [[ ! -d "$root" ]]; then
    mkdir -p "$root"
    tar -C "$root" -xf "$roots/$suite.tar"
  fi
  if [[ -e /etc/resolv.conf ]]; then cp -L /etc/resolv.conf "$root/etc/resolv.conf"; fi
  inside "$root" apt-get update -q
done

heading "build"
# What was built the last time is kept, if the system was.
mkdir -p "$builder/sfdae"
find "$builder/sfdae" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} +
rm -f "$builder"/sfdae/build/package/*.{deb,tar.gz}
git ls-files -z | tar --null -T - -cf - | tar -C "$builder/sfdae" -xf -
inside "$builder" sh -ec "
  cd /sfdae
  scripts/install-dependencies.sh package
  cmake --preset package -G Ninja -DSFDAE_WERROR=ON
  cmake --build build/package --parallel $jobs
  (cd build/package && cpack)
  cd python
  python3 setup.py -q sdist -d /sfdae/build/package"
rm -rf "$packages"
mkdir -p "$packages"
cp "$builder"/sfdae/build/package/*.{deb,tar.gz} "$packages"
ls -l "$packages"

heading "rules of Debian"
install_in "$builder" lintian
# The maintainer is whoever makes packages: CPACK_DEBIAN_PACKAGE_MAINTAINER.
inside "$builder" sh -c "lintian --allow-root --fail-on error --tag-display-limit 0 \
  --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog /sfdae/build/package/*.deb"

if [[ "${2:-}" == tests ]]; then
  heading "tests"
  inside "$builder" sh -ec "
    cd /sfdae
    scripts/install-dependencies.sh test
    cmake --preset release -G Ninja -DSFDAE_WERROR=ON
    cmake --build build/release --parallel $jobs
    ctest --preset release -LE '^(long|install)$'"
fi

heading "program and Python, with nothing but what they depend on"
mkdir -p "$clean/packages"
cp "$packages"/* "$clean/packages"
# Paths, so that apt takes these packages and finds the rest by itself.
mapfile -t programs < <(cd "$packages" && find . -name '*.deb' ! -name 'libsfdae-dev*' -printf '/packages/%P\n')
install_in "$clean" "${programs[@]}"
inside "$clean" python3 -c '
import math, sfdae
sol = sfdae.solve(lambda t, x, xdot: [xdot[0] - x[1], xdot[1] + x[0]], (0, 1), [1, 0], rtol=1e-8, atol=1e-8)
assert sol.success and abs(sol.x[0, -1] - math.cos(1)) < 1e-6, sol
print("Python: sfdae", sfdae.__version__)'
if [[ -e "$clean/usr/bin/sfdae" ]]; then
  inside "$clean" sfdae --version
  for model in "$clean"/usr/share/sfdae/models/*.mo; do
    inside "$clean" sfdae check "${model#"$clean"}" > /dev/null
  done
  inside "$clean" sfdae solve /usr/share/sfdae/models/pendulum.mo --to 1 --csv /tmp/pendulum.csv
  [[ -s "$clean/tmp/pendulum.csv" ]]
fi

heading "C, C++, Fortran"
install_in "$clean" "/packages/$(basename "$packages"/libsfdae-dev*.deb)" gcc g++ gfortran cmake make pkg-config liblapack-dev
cp -r tests/install/consumer "$clean/consumer"
inside "$clean" sh -ec '
  mkdir -p /work && cd /work
  examples=/usr/share/doc/sfdae/examples
  flags=$(pkg-config --cflags --libs sfdae)
  modules=$(pkg-config --variable=fortrandir sfdae)
  gcc -Wall $examples/pendulum.c $flags -lm -o pendulum_c
  g++ -Wall -std=c++17 $examples/pendulum.cpp $flags -o pendulum_cpp
  gfortran -c $(sed "s|^|$modules/|" $modules/sources.txt)
  gfortran $examples/pendulum.f90 *.o $flags -o pendulum_fortran
  gfortran -std=legacy $examples/dgelda.f $flags -o dgelda
  archives=$(pkg-config --static --cflags --libs sfdae)
  gcc -static $examples/pendulum.c $archives -lm -o archives_c
  gfortran -static -std=legacy $examples/dgelda.f $archives -o archives_dgelda
  for program in pendulum_c pendulum_cpp pendulum_fortran dgelda archives_c archives_dgelda; do
    ./$program > $program.txt
    echo "$program: ok"
  done
  for language in C CXX Fortran; do
    for variant in shared static; do
      cmake -S /consumer -B $language-$variant -DCONSUMER_LANGUAGE=$language -DCONSUMER_VARIANT=$variant \
        -DCONSUMER_ONLY_LANGUAGE=OFF > cmake.txt
      cmake --build $language-$variant > cmake.txt
      cmake --build $language-$variant --target run
    done
  done'

heading "removal"
inside "$clean" apt-get purge -q -y libsfdae0* > "$roots/purge.txt" || { cat "$roots/purge.txt"; exit 1; }
[[ ! -e "$clean/usr/include/sfdae" && ! -e "$clean/usr/lib/python3/dist-packages/sfdae/_solve.py" ]]

# As python/README.md says, with the source distribution in place of the checkout, and the program that stands there.
heading "pip install of the source distribution, without a package index"
cp scripts/install-dependencies.sh "$clean"
sed -n '/^```python$/,/^```$/{/^```/d;p}' python/README.md > "$clean/pendulum.py"
lines="$(wc -l < "$clean/pendulum.py")"
if [[ "$lines" -eq 0 || "$lines" -gt 10 ]]; then
  echo "python/README.md: its program has $lines lines, expected 1 to 10" >&2
  exit 1
fi
inside "$clean" sh -ec "
  /install-dependencies.sh python
  python3 -m venv --system-site-packages /venv
  CMAKE_BUILD_PARALLEL_LEVEL=$jobs /venv/bin/pip install --quiet --no-index --no-build-isolation /packages/sfdae-*.tar.gz
  cd /tmp
  MPLBACKEND=Agg /venv/bin/python /pendulum.py
  grep -q '<path ' pendulum.svg
  /venv/bin/python -c 'import sfdae; assert sfdae.__file__.startswith(\"/venv/\"); print(\"sfdae\", sfdae.__version__)'"
