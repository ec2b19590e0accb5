#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Unit tests under the address and undefined-behaviour sanitizers (build-sanitize/), under that for threads
# (build-tsan/) or in Debug (build-debug/); the assertions of Eigen and of the standard library hold in each:
#   Testing/check-sanitizers.sh [MODULE...]             default: every module whose unit tests are fast
#   Testing/check-sanitizers.sh --threads [MODULE...]   default: Harmonic, Repulsion, Correspondence, Unfolding
#   Testing/check-sanitizers.sh --debug [MODULE...]     default: every module
# Any finding ends a test with a failure and the place.  EXPLICA_JOBS bounds the compilers at once.
set -eu
cd "$(dirname "$0")/.."
preset=sanitize
case "${1:-}" in
  --threads)
    preset=tsan
    shift
    [ $# -gt 0 ] || set -- Harmonic Repulsion Correspondence Unfolding
    ;;
  --debug)
    preset=debug
    shift
    # shellcheck disable=SC2046  # a list of words
    [ $# -gt 0 ] || set -- $(ls -d Modules/*/test | cut -d/ -f2)
    ;;
esac
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
# Embree builds its trees on TBB's threads; neither library is instrumented, so that the sanitizer sees what Embree
# allocates, copies and frees there but not what orders it.  Only calls out of Embree's own code are left out.
echo 'called_from_lib:libembree3' >"$folder/races.supp"
export TSAN_OPTIONS="suppressions=$PWD/$folder/races.supp"
failed=""
for target in $targets; do
  began=$(date +%s)
  "$folder/bin/$target" --gtest_brief=1 || failed="$failed $target"
  echo "$target: $(($(date +%s) - began)) s"
done
[ -z "$failed" ] || { echo "$preset: failures in$failed"; exit 1; }
