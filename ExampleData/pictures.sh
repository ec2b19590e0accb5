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

$view /usr/share/mricron/templates/ch2bet.nii.gz "$out/surface/white.surf.gii" "$out/surface/pial.surf.gii" \
  --slices 2 --height 660 --screenshot "$to/slices.png"
$view "$out/surface/pial.surf.gii" --map "$out/surface/thickness.shape.gii" --width 380 --height 300 \
  --screenshot "$to/thickness.png"
frames=$(find "$out/unfold/frames" -name 'frame-*.surf.gii' | sort)
last=$(echo "$frames" | tail -n 1)
$view "$out/surface/mid.surf.gii" "$last" --map "$out/surface/curvature.shape.gii" --colours diverging \
  --range -0.4,0.4 --region "$out/unfold/region.label.gii" --direction -1,0,0 --focus --width 420 --height 330 \
  --screenshot "$to/unfolding.png"
$view "$out/unfold" --map "$out/surface/curvature.shape.gii" --colours diverging --range -0.4,0.4 --region "$out/unfold/region.label.gii" \
  --direction -1,0,0 --focus --width 190 --height 150 --film "$to/unfolding.gif"
echo "Look at $to"
