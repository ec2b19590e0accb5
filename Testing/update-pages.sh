#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Writes Applications/<Name>/README.md anew from the declarations of the commands in build/.
set -eu
cd "$(dirname "$0")/.."
cmake --build build --target explica ExplicaReferencePagesCommandTests
EXPLICA_UPDATE_PAGES=1 build/bin/ExplicaReferencePagesCommandTests
