#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# The worked example: installs what is needed, builds, and takes Colin27 (a real 1 mm T1 of Debian's
# mricron-data, skull-stripped, with the AAL atlas in its space) from T1 to unfolded patches of both
# hemispheres.  Safe to run again: steps that are still true are kept.
#   ExampleData/run.sh [options of explica run]
set -eu
cd "$(dirname "$0")/.."
Testing/setup.sh

templates=/usr/share/mricron/templates
out=build/colin27
build/bin/explica run "$templates/ch2bet.nii.gz" --atlas "$templates/aal.nii.gz" --out "$out" --resume "$@" || status=$?
# 3: stopped before its goal, with results.
if [ "${status:-0}" != 0 ] && [ "${status:-0}" != 3 ]; then
  exit "$status"
fi
echo "Look at $PWD/$out/report.html in a browser"

# The image on the patch of the left hemisphere, with AAL's regions: over the depth of the cortex, and flat.
left=$out/surface-L
if [ -d "$left" ] && [ -d "$out/unfold-L" ]; then
  sample="build/bin/explica sample $templates/ch2bet.nii.gz --surfaces $left --force --quiet"
  $sample --depths 11 --labels "$left/regions.label.gii" --out "$out-profiles"
  $sample --depths 0.5 --out "$out-middle"
  build/bin/explica flatten "$out/unfold-L/unfolded.surf.gii" --surfaces "$left" --depths 7 \
    --volumes "$templates/ch2bet.nii.gz" --map "$out-middle/ch2bet.func.gii" \
    --regions "$left/regions.label.gii" --out "$out-flat" --force --quiet
  for folder in "$out-profiles" "$out-flat"; do
    build/bin/explica report "$folder" --quiet
    echo "and at $PWD/$folder/report.html"
  done
fi
