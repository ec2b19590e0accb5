#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Installs what Testing/packages.txt lists, if anything is missing, and builds Release into build/.
# Safe to run again.  EXPLICA_PRESET=ci makes warnings errors.
set -eu
cd "$(dirname "$0")/.."

missing=""
for package in $(sed 's/#.*//' Testing/packages.txt); do
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

# Debian's packages for Python belong to Debian's python3, whichever comes first in PATH.
cmake --preset "${EXPLICA_PRESET:-release}" -DPython_EXECUTABLE=/usr/bin/python3
cmake --build build
echo "setup: built build/bin/explica"
