#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Unit tests under the address and undefined-behaviour sanitizers, in build-sanitize/, or under that for threads, in
# build-tsan/:
#   Testing/check-sanitizers.sh [MODULE...]             default: every module whose unit tests are fast
#   Testing/check-sanitizers.sh --threads [MODULE...]   default: Repulsion, Correspondence, Unfolding
# Any finding ends a test with a failure and the place.  EXPLICA_JOBS bounds the compilers at once.
set -eu
cd "$(dirname "$0")/.."
preset=sanitize
if [ "${1:-}" = --threads ]; then
  preset=tsan
  shift
  [ $# -gt 0 ] || set -- Repulsion Correspondence Unfolding
fi
[ $# -gt 0 ] || set -- Core Geometry Collision Visibility Repulsion Unfolding Planar Shapes Harmonic \
  Correspondence Surface Segmentation Report Study IO Provenance Phantom Viewer
targets=$(printf 'Explica%sUnitTests ' "$@")
folder=build-$preset
[ -f "$folder/build.ninja" ] || cmake --preset "$preset"
# shellcheck disable=SC2086  # a list of words
cmake --build "$folder" ${EXPLICA_JOBS:+-j "$EXPLICA_JOBS"} --target $targets
export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_init_order=1
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
# ITK's reader of NRRD forgets its buffers and messages when a file turns out to be damaged.
printf 'leak:libITKNrrdIO\nleak:libz.so\n' >"$folder/leaks.supp"
export LSAN_OPTIONS="suppressions=$PWD/$folder/leaks.supp:print_suppressions=0"
failed=""
for target in $targets; do
  "$folder/bin/$target" --gtest_brief=1 || failed="$failed $target"
done
[ -z "$failed" ] || { echo "sanitizers: failures in$failed"; exit 1; }
