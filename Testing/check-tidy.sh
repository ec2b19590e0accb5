#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# clang-tidy over the sources that differ from a commit (default: all), as .clang-tidy says:
#   Testing/check-tidy.sh [COMMIT]
# Needs Debian's clang-tidy; the flags come from build-tidy/, configured without precompiled headers
# (clang reads none of GCC's).
set -eu
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
  files=$(git diff --name-only --diff-filter=d "$1" -- '*.cpp')
else
  files=$(git ls-files '*.cpp')
fi
cmake --preset ci -B build-tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
  -DEXPLICA_BUILD_BENCHMARKS=ON >/dev/null
# What this build does not compile (the consumer project) has no flags to check it with.
files=$(for file in $files; do grep -q -F "/$file\"" build-tidy/compile_commands.json && echo "$file"; done || true)
[ -n "$files" ] || exit 0

check() {
  xargs -r -P "$(nproc)" -n 4 clang-tidy -p build-tidy --quiet --warnings-as-errors='*' \
    --extra-arg=-Wno-unknown-warning-option "$@"
}
failed=0
echo "$files" | grep -v '^Modules/IO/' | check || failed=1
# Debian's ITK headers know no compiler but GCC.
echo "$files" | grep '^Modules/IO/' | check --extra-arg=-U__clang__ --extra-arg=-fgnuc-version=10.2.0 ||
  failed=1
exit "$failed"
