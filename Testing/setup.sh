#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Installs packages, where some are missing, and builds Release into build/.  Safe to run again.
#   Testing/setup.sh              all: ExampleData/packages.txt, Testing/packages.txt; tests, window, Python module
#   Testing/setup.sh --program    ExampleData/packages.txt and the program alone, as ExampleData/run.sh does
# EXPLICA_PRESET=ci makes warnings errors.
set -eu
cd "$(dirname "$0")/.."
lists="ExampleData/packages.txt Testing/packages.txt"
target=all
options="-DEXPLICA_BUILD_TESTS=ON -DEXPLICA_BUILD_PYTHON=ON -DEXPLICA_WITH_WINDOW=ON"
if [ "${1:-}" = --program ]; then
  lists=ExampleData/packages.txt
  target=explica
  options="-DEXPLICA_BUILD_TESTS=OFF -DEXPLICA_BUILD_PYTHON=OFF -DEXPLICA_WITH_WINDOW=OFF"
  # A folder that is set up for tests stays so: only the program is built in it.
  if grep -q '^EXPLICA_BUILD_TESTS:BOOL=ON' build/CMakeCache.txt 2>/dev/null; then options=""; fi
fi

missing=""
# shellcheck disable=SC2086  # one word per list is meant
for package in $(sed 's/#.*//' $lists); do
  if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)" != installed ]; then
    missing="$missing $package"
  fi
done
if [ -n "$missing" ]; then
  as_root=""
  if [ "$(id -u)" != 0 ]; then
    as_root="sudo"
  fi
  echo "setup: installing$missing"
  export DEBIAN_FRONTEND=noninteractive
  $as_root apt-get update -q
  # shellcheck disable=SC2086  # one word per package is meant
  $as_root apt-get install -q -y --no-install-recommends $missing
fi

# What CMake finds is of interest where it fails: Debian's ITK alone has it print a hundred lines.
echo "setup: configuring"
mkdir -p build
# Debian's packages for Python belong to Debian's python3, whichever comes first in PATH.
# shellcheck disable=SC2086
cmake --preset "${EXPLICA_PRESET:-release}" -DPython_EXECUTABLE=/usr/bin/python3 $options >build/configure.log 2>&1 || {
  cat build/configure.log
  exit 1
}
# A line each half minute, with what is left at the pace so far; all else as it comes.  Not by awk:
# Debian's (mawk) waits for 4096 bytes.
status=$(mktemp)
lines=0
{ NINJA_STATUS="built %f of %t files in %e s: " cmake --build build --target "$target" || echo $? >"$status"; } |
  while IFS= read -r line; do
    case $line in
      "built "*" of "*)
        # shellcheck disable=SC2086  # one argument per word is meant
        set -- $line
        seconds=${7%.*}
        if [ "$seconds" -ge $((30 * (lines + 1))) ] || [ "$2" = "$4" ]; then
          lines=$((seconds / 30))
          echo "setup: $2 of $4 files built, about $(((seconds * ($4 - $2) / $2 + 59) / 60)) min left"
        fi
        ;;
      *) printf '%s\n' "$line" ;;
    esac
  done
failed=$(cat "$status")
rm -f "$status"
[ -z "$failed" ] || exit "$failed"
echo "setup: built build/bin/explica"
