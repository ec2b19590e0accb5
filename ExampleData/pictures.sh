#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Draws the pictures of the README from the worked example's results (ExampleData/run.sh).
set -eu
cd "$(dirname "$0")/.."
out=${1:-build/colin27}
to=ExampleData/pictures
view="build/bin/explica view"
mkdir -p "$to"

$view /usr/share/mricron/templates/ch2bet.nii.gz "$out/surface-L/white.surf.gii" "$out/surface-L/pial.surf.gii" \
  --slices 2 --height 660 --screenshot "$to/slices.png"
$view "$out/surface-L/pial.surf.gii" --map "$out/surface-L/thickness.shape.gii" --width 380 --height 300 \
  --screenshot "$to/thickness.png"
frames=$(find "$out/unfold-L/frames" -name 'frame-*.surf.gii' | sort)
last=$(echo "$frames" | tail -n 1)
$view "$out/surface-L/mid.surf.gii" "$last" --map "$out/surface-L/curvature.shape.gii" --colours diverging \
  --range -0.4,0.4 --region "$out/unfold-L/region.label.gii" --direction -1,0,0 --focus --width 420 --height 330 \
  --screenshot "$to/unfolding.png"
$view "$out/unfold-L" --map "$out/surface-L/curvature.shape.gii" --colours diverging --range -0.4,0.4 \
  --direction -1,0,0 --width 260 --height 220 --film "$to/unfolding.gif"
cp "$out-flat/flat.png" "$to/flat.png"
echo "Look at $to"
