#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Fails, with the differences, if a C++ file is not as clang-format would write it.
set -eu
cd "$(dirname "$0")/.."
find Modules Applications Testing Wrapping \( -name '*.h' -o -name '*.cpp' \) -print0 |
  xargs -0 "${1:-clang-format}" --dry-run --Werror --ferror-limit=3
