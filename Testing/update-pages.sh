#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Writes what is kept of all that follows from the commands' declarations anew, by what build/ makes:
# the pages Applications/<Name>/README.md, the table of Modules/README.md, and one small sample of each format in
# Wrapping/*/test/golden.  Look at the difference before it is committed.
#   Testing/update-pages.sh          pages and samples of the descriptions
#   Testing/update-pages.sh python   the sample of the Python module's stubs, too
set -eu
cd "$(dirname "$0")/.."
Modules/CMake/dependencies.py --update
export EXPLICA_UPDATE_PAGES=1
cmake --build build ${EXPLICA_JOBS:+-j "$EXPLICA_JOBS"} --target descriptors ExplicaCommandTests
build/bin/ExplicaCommandTests --gtest_brief=1 --gtest_filter='ReferencePages*'
ctest --test-dir build -R '^Descriptors$' --output-on-failure
if [ "${1:-}" = python ]; then
  cmake --build build ${EXPLICA_JOBS:+-j "$EXPLICA_JOBS"} --target _explica
  ctest --test-dir build -R '^Python.test_types$' --output-on-failure
fi
