#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Builds the numerics that need headers only (polygons; in space: Laplace's equation, trajectories,
# distances, intersections, collisions, repulsion) for arm64 and for this processor by the same compiler
# version, runs both (arm64 under qemu) and prints what differs.  Needs Debian's g++-aarch64-linux-gnu,
# qemu-user, libeigen3-dev and libhwy-dev.  The whole program cannot be built so: Debian's ITK, VTK, HDF5,
# ISA-L and yaml-cpp cannot be installed for arm64 beside amd64.
set -eu
cd "$(dirname "$0")/.."
for tool in aarch64-linux-gnu-g++-12 qemu-aarch64; do
  command -v $tool >/dev/null || { echo "check-arm64: $tool is missing"; exit 2; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
planar="Testing/arm64/Digests.cpp Modules/Geometry/src/Predicates.cpp"
for name in AngularSweep Curve EdgeTree ExplicitMethod ImplicitMethod PolygonCollision PolygonKnotEnergy \
  PolygonMeasures PolygonPhantoms PolygonUnfolding PolygonVisibility UnfoldingProblem; do
  planar="$planar Modules/Planar/src/$name.cpp"
done
space="Testing/arm64/SpaceDigests.cpp Modules/Core/src/Grid.cpp Modules/Core/src/VolumeOnDemand.cpp
  Modules/Phantom/src/Shell.cpp"
for module in Geometry Harmonic Repulsion; do space="$space $(echo Modules/$module/src/*.cpp)"; done
for name in Correspondence Field HalfwaySurface; do space="$space Modules/Correspondence/src/$name.cpp"; done
for name in CollisionScene ContinuousCollision MeetingKernels Proximity; do
  space="$space Modules/Collision/src/$name.cpp"
done
includes="-isystem /usr/include/eigen3 -isystem $work/include"
for module in Core Geometry Planar Harmonic Correspondence Phantom Collision Repulsion; do
  includes="$includes -I Modules/$module/include -I Modules/$module/src"
done
mkdir "$work/include"
ln -s /usr/include/hwy "$work/include/hwy" # without this processor's other headers
# digests COMPILER NAME SOURCE...: each program, of one processor's instructions at a time
digests() {
  compiler=$1 name=$2
  shift 2
  # shellcheck disable=SC2086  # one word per folder is meant
  $compiler -std=c++20 -O1 -fno-builtin -ffp-contract=off -DNDEBUG -DHWY_COMPILE_ONLY_STATIC $includes \
    "$@" Testing/arm64/OneThread.cpp -static -o "$work/$name"
}
for program in planar space; do
  eval "sources=\$$program"
  # shellcheck disable=SC2086  # one word per source is meant
  digests g++-12 $program-amd64 $sources
  # shellcheck disable=SC2086
  digests aarch64-linux-gnu-g++-12 $program-arm64 $sources
  "$work/$program-amd64" >>"$work/amd64.txt"
  qemu-aarch64 "$work/$program-arm64" >>"$work/arm64.txt"
done
cat "$work/arm64.txt"
echo "differs (< amd64, > arm64):"
diff "$work/amd64.txt" "$work/arm64.txt" || true
