#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Simulated heads of known tissue through `segment`, or with --surfaces through `run --steps segment,surface`, beside the truth:
#   Testing/population.sh build/bin/explica WORK [--surfaces] [--people 03,05] [--variants 1,2,3]
# Rows that are there already are not made again; the table is WORK/population.tsv.  Needs ../shared/data and ../shared/referee.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec "${PYTHON:-/usr/bin/python3}" "$here/population/population.py" "$@"
