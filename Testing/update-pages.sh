#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Writes what follows from the commands' declarations anew, by the commands in build/: the pages
# Applications/<Name>/README.md, the descriptions for other tools in Wrapping/Descriptors, and the type
# stubs of the Python module.
set -eu
cd "$(dirname "$0")/.."
cmake --build build --target explica descriptors _explica ExplicaReferencePagesCommandTests
EXPLICA_UPDATE_PAGES=1 build/bin/ExplicaReferencePagesCommandTests
for kind in boutiques completion man nipype slicer; do
  rm -rf "Wrapping/Descriptors/$kind"
  cp -r "build/descriptors/$kind" Wrapping/Descriptors/
done
PYTHONPATH=build/python PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 Wrapping/Python/tools/make_stubs.py
