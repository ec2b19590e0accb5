#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Breaks the code in some fifty places, one at a time, and fails where no test notices (Testing/mutations.py).
#   Testing/mutations.sh [--only WORD]
set -eu
cd "$(dirname "$0")/.."
[ -f build/build.ninja ] || { echo "mutations.sh: configure build/ first (Testing/setup.sh)" >&2; exit 1; }
exec /usr/bin/python3 Testing/mutations.py "$@"
