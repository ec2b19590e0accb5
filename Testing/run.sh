#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Sets up, builds and runs every test; arguments go to ctest, e.g. -L unit.
set -eu
cd "$(dirname "$0")/.."
Testing/setup.sh

# Batch commands must do without a display.
unset DISPLAY WAYLAND_DISPLAY
failed=0
ctest --test-dir build --parallel "$(nproc)" --output-on-failure "$@" || failed=$?
if [ "$failed" = 0 ]; then
  echo "All tests passed. Look at build/Testing/Temporary/LastTest.log for each one's output."
else
  # What failed stands at the end too, where one looks first.
  awk '/^[0-9]+\/[0-9]+ Testing: / { block = ""; } { block = block $0 "\n" }
       /^Test Failed\.$/ { printf "%s", block }' build/Testing/Temporary/LastTest.log
  echo "Tests failed. Look above, and at build/Testing/Temporary/LastTestsFailed.log."
fi
exit "$failed"
