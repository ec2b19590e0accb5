#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# The worked example: installs what building takes, builds the program, and takes Colin27 (a real 1 mm T1 of Debian's
# mricron-data, skull-stripped, with the AAL atlas in its space) from T1 to unfolded patches of both
# hemispheres.  Safe to run again: steps that are still true are kept.
#   ExampleData/run.sh [options of explica run]
set -eu
cd "$(dirname "$0")/.."
echo "1 of 3: packages (ExampleData/packages.txt) and the program"
Testing/setup.sh --program

templates=/usr/share/mricron/templates
out=build/colin27
echo "2 of 3: from T1 to unfolded patches; steps that an earlier run has done are kept"
explica_run() {
  build/bin/explica run "$templates/ch2bet.nii.gz" --atlas "$templates/aal.nii.gz" --out "$out" --resume "$@"
}
# The default template is Colin27, too: its surfaces and spheres serve as the template, and are not made twice.
explica_run --steps segment,surface,sphere || status=$?
case ${status:-0} in
  0 | 3) status=0 && { explica_run --template "$out" "$@" || status=$?; } ;;
esac
# 3: stopped before its goal, with results.
if [ "${status:-0}" != 0 ] && [ "${status:-0}" != 3 ]; then
  exit "$status"
fi
# The image on the patch of the left hemisphere, with AAL's regions: over the depth of the cortex, and flat.
left=$out/surface-L
echo "3 of 3: the T1 over the depth of the cortex, and on a flat map"
if [ -d "$left" ] && [ -d "$out/unfold-L" ]; then
  sample="build/bin/explica sample $templates/ch2bet.nii.gz --surfaces $left --force --quiet"
  $sample --depths 11 --labels "$left/regions.label.gii" --out "$out-profiles"
  $sample --depths 0.5 --out "$out-middle"
  build/bin/explica flatten "$out/unfold-L/unfolded.surf.gii" --surfaces "$left" --depths 7 \
    --volumes "$templates/ch2bet.nii.gz" --map "$out-middle/ch2bet.func.gii" \
    --regions "$left/regions.label.gii" --out "$out-flat" --force --quiet
  for folder in "$out-profiles" "$out-flat"; do
    build/bin/explica report "$folder" --quiet
  done
fi
echo "Look at $PWD/$out/report.html in a browser"
for folder in "$out-profiles" "$out-flat"; do
  if [ -f "$folder/report.html" ]; then echo "and at $PWD/$folder/report.html"; fi
done
