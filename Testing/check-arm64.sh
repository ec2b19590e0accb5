#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Testing/check-arm64.sh [MODULE...]      default: Core Geometry
# Builds for arm64, by Debian's cross compiler, and runs under qemu the unit tests of modules, and the
# polygons' numerics (Modules/Planar), whose bits it compares with those of this processor.  Needs
# Debian's g++-aarch64-linux-gnu, qemu-user, libeigen3-dev, libhwy-dev and googletest (its sources);
# oneTBB is replaced by one thread.  The whole program cannot be built so: Debian's ITK, VTK, HDF5,
# ISA-L and yaml-cpp cannot be installed for arm64 beside amd64.
set -eu
cd "$(dirname "$0")/.."
gtest=/usr/src/googletest/googletest
for tool in aarch64-linux-gnu-g++-12 qemu-aarch64 "$gtest/src/gtest-all.cc"; do
  command -v "$tool" >/dev/null || [ -f "$tool" ] || { echo "check-arm64: $tool is missing"; exit 2; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-std=c++20 -O1 -fno-builtin -ffp-contract=off -DNDEBUG -DHWY_COMPILE_ONLY_STATIC \
  -isystem /usr/include/eigen3"
for module in Core Geometry Harmonic Planar; do
  flags="$flags -I Modules/$module/include -I Modules/$module/src"
done
# compiled COMPILER NAME SOURCE...: the program $work/NAME
compiled() {
  compiler=$1 name=$2
  shift 2
  mkdir -p "$work/$name.o"
  for source in "$@"; do
    # shellcheck disable=SC2086  # one word a flag is meant
    $compiler $flags -isystem $gtest/include -I $gtest -c "$source" \
      -o "$work/$name.o/$(echo "$source" | tr / _).o"
  done
  $compiler -static "$work/$name.o"/*.o -o "$work/$name"
}

# Unit tests, but for those that need other modules or several threads.
failed=""
[ $# -gt 0 ] || set -- Core Geometry
for module in "$@"; do
  sources="Testing/arm64/OneThread.cpp Modules/Core/src/PortableMath.cpp Modules/Core/src/Grid.cpp"
  for source in Modules/Core/src/*.cpp "Modules/$module"/src/*.cpp; do
    case " $sources Modules/Core/src/Parallel.cpp " in *" $source "*) ;; *) sources="$sources $source" ;; esac
  done
  for test in "Modules/$module"/test/*Test.cpp; do
    grep -q 'Explica/Testing/\|threadCount' "$test" || sources="$sources $test"
  done
  # shellcheck disable=SC2086  # one word a source is meant
  compiled aarch64-linux-gnu-g++-12 "$module" $sources $gtest/src/gtest-all.cc $gtest/src/gtest_main.cc
  qemu-aarch64 "$work/$module" --gtest_brief=1 || failed="$failed $module"
done

sources="Testing/arm64/Digests.cpp Testing/arm64/OneThread.cpp Modules/Core/src/PortableMath.cpp \
  Modules/Geometry/src/Predicates.cpp"
for name in AngularSweep Curve EdgeTree ExplicitMethod ImplicitMethod PolygonCollision PolygonKnotEnergy \
  PolygonMeasures PolygonPhantoms PolygonUnfolding PolygonVisibility UnfoldingProblem; do
  sources="$sources Modules/Planar/src/$name.cpp"
done
# shellcheck disable=SC2086  # one word a source is meant
compiled g++-12 amd64 $sources
# shellcheck disable=SC2086
compiled aarch64-linux-gnu-g++-12 arm64 $sources
"$work/amd64" >"$work/amd64.txt"
qemu-aarch64 "$work/arm64" >"$work/arm64.txt"
cat "$work/arm64.txt"
echo "differs (< amd64, > arm64):"
diff "$work/amd64.txt" "$work/arm64.txt" || true
[ -z "$failed" ] || { echo "check-arm64: tests failed in$failed"; exit 1; }
