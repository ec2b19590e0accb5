#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Builds the polygons' numerics (Modules/Planar) for arm64 and for this processor by the same compiler
# version, runs both (arm64 under qemu) and prints what differs.  Needs Debian's g++-aarch64-linux-gnu,
# qemu-user and libeigen3-dev.  The whole program cannot be built so: Debian's ITK, VTK, HDF5, ISA-L and
# yaml-cpp cannot be installed for arm64 beside amd64.
set -eu
cd "$(dirname "$0")/.."
for tool in aarch64-linux-gnu-g++-12 qemu-aarch64; do
  command -v $tool >/dev/null || { echo "check-arm64: $tool is missing"; exit 2; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sources="Testing/arm64/Digests.cpp Modules/Geometry/src/Predicates.cpp"
for name in AngularSweep Curve EdgeTree ExplicitMethod ImplicitMethod PolygonCollision PolygonKnotEnergy \
  PolygonMeasures PolygonPhantoms PolygonUnfolding PolygonVisibility UnfoldingProblem; do
  sources="$sources Modules/Planar/src/$name.cpp"
done
# digests COMPILER NAME [FLAG...]
digests() {
  compiler=$1 name=$2
  shift 2
  # shellcheck disable=SC2086  # one word per source is meant
  $compiler -std=c++20 -O1 -fno-builtin -ffp-contract=off -DNDEBUG "$@" -I Modules/Core/include \
    -I Modules/Geometry/include -I Modules/Planar/include -I Modules/Planar/src \
    -isystem /usr/include/eigen3 $sources -static -o "$work/$name"
}
digests g++-12 amd64
digests aarch64-linux-gnu-g++-12 arm64
"$work/amd64" >"$work/amd64.txt"
qemu-aarch64 "$work/arm64" >"$work/arm64.txt"
cat "$work/arm64.txt"
echo "differs (< amd64, > arm64):"
diff "$work/amd64.txt" "$work/arm64.txt" || true
