#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Measures again the numbers of Testing/validation/README.md ("How right is it?") with the program in
# build/, and fails where one is off by more than the page allows.  Some minutes on two idle cores.
#   Testing/validate.sh [--write] [--only WORD] [--no-times] [--work FOLDER]
# Real data come from ../shared/data; what is not there is said and left out.
set -eu
cd "$(dirname "$0")/.."
exec /usr/bin/python3 Testing/validation/validate.py build/bin/explica "$@"
