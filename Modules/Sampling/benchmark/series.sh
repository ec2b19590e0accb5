#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Time of a whole command on a functional series: S1's left hemisphere (152,893 vertices) at 11 depths and 300 frames,
# its echo-planar image with noise.  Needs ../shared/data (s1_pycortex_lh), python3-nibabel and time.
#   Modules/Sampling/benchmark/series.sh [explica]
set -eu
cd "$(dirname "$0")/../../.."
explica=${1:-build/bin/explica}
data=../shared/data/s1_pycortex_lh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
/usr/bin/python3 - "$data/transforms/fullhead_reference.nii.gz" "$folder/bold.nii.gz" <<'MAKE'
import sys

import nibabel
import numpy as np

image = nibabel.load(sys.argv[1])
random = np.random.default_rng(7)
frames = [image.get_fdata() + random.normal(0, 20, image.shape) for _ in range(300)]
made = nibabel.Nifti1Image(np.rint(np.stack(frames, -1)).astype("i2"), image.affine)
nibabel.save(made, sys.argv[2])
MAKE
for across in none mean; do
  command time -f "--across $across: %U s user, %S s system, %e s, %M kB" \
    "$explica" sample "$folder/bold.nii.gz" --white "$data/wm_lh.gii" --pial "$data/pia_lh.gii" \
    --to-volume "$data/transforms/fullhead_matrices.xfm" --depths 11 --across "$across" --out "$folder/out" --force --quiet
done
