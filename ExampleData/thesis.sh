#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# The thesis, figure by figure: runs every simulation on phantoms and writes OUT/thesis.html, one
# self-contained page with the figures and each reported number beside ours, and OUT/thesis.json.
#   ExampleData/thesis.sh [OUT [--fsaverage DIR] [--heart LABELS]]
# DIR holds nilearn's fsaverage5 (pial_left.gii.gz, infl_left.gii.gz, sphere_left.gii.gz,
# flat_left.gii.gz): figures 5.25 to 5.27 are then of that cortex.  LABELS is a short-axis label
# volume (1 cavity, 2 wall): figure 3.3 is then of that heart.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
out=${1:-build/thesis}
[ $# -gt 0 ] && shift
exec /usr/bin/python3 "$here/thesis.py" --explica "${EXPLICA:-$here/../build/bin/explica}" --out "$out" "$@"
