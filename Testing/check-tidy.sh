#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# clang-tidy over the sources that differ from a commit (default: all), as .clang-tidy says:
#   Testing/check-tidy.sh [COMMIT]
# Needs Debian's clang-tidy and a configured build/.
set -eu
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
  files=$(git diff --name-only --diff-filter=d "$1" -- '*.cpp')
else
  files=$(git ls-files '*.cpp')
fi
[ -n "$files" ] || exit 0
echo "$files" | grep -v -e '^Testing/consumer/' |
  xargs -P "$(nproc)" -n 4 clang-tidy -p build --quiet --warnings-as-errors='*'
