#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Unfolds random patches of every surface at hand and measures the files again, with code of its own:
#   Testing/patches.sh build/bin/explica WORK [--seeds 0-199 | --count 24 --half settle | --campaign 1000] [--referee PROGRAM] [--make] [-- OPTIONS of unfold]
# A campaign is of other seeds and of all surroundings; stopped, it goes on where it was.
# Even seeds are those constants may be settled on; odd seeds are for judging alone.  Rows that are there already are not
# made again; the table is WORK/patches.tsv.  Needs ../shared/data; --make makes the surfaces of bert, Colin27 and the macaque (WORK/surfaces).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec "${PYTHON:-/usr/bin/python3}" "$here/patches/patches.py" "$@"
