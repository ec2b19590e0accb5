#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""A block of tissue cut out of a hemisphere's ribbon, as `explica surface` of blocks is measured on.

    block_of_ribbon.py RIBBON OUT.nii.gz [--grey-label 760000]

RIBBON is FreeSurfer's ribbon.mgz.  The block is the middle of the left hemisphere's box, cut on all
sides, each voxel split into eight; white matter is 2, grey matter 3.  It is as large as it must be
for about --grey voxels of grey matter.  Prints how many it has.
"""
import argparse
import pathlib

import nibabel as nib
import numpy as np

WHITE, GREY = 2, 3
SPLIT = 2  # along each axis


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("ribbon", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--grey", type=int, default=760000, help="voxels of the block, about")
    chosen = parser.parse_args()

    ribbon = nib.as_closest_canonical(nib.load(chosen.ribbon))
    labels = np.asarray(ribbon.dataobj).astype(np.int16)
    labels[(labels != WHITE) & (labels != GREY)] = 0
    used = np.argwhere(labels > 0)
    middle, half = (used.max(axis=0) + used.min(axis=0)) / 2, np.ptp(used, axis=0) / 2
    for share in np.linspace(0.3, 1, 200):
        low = np.round(middle - share * half).astype(int)
        high = np.round(middle + share * half).astype(int) + 1
        block = labels[tuple(slice(a, b) for a, b in zip(low, high))]
        if (block == GREY).sum() * SPLIT**3 >= chosen.grey:
            break
    for axis in range(3):
        block = np.repeat(block, SPLIT, axis=axis)
    affine = ribbon.affine.copy()
    affine[:3, 3] = (ribbon.affine @ np.append(low - 0.5 + 0.5 / SPLIT, 1))[:3]
    affine[:3, :3] /= SPLIT
    nib.save(nib.Nifti1Image(block, affine), chosen.out)
    print(f"{(block == GREY).sum()} voxels of grey matter, {(block == WHITE).sum()} of white, "
          f"{' x '.join(map(str, block.shape))} voxels of {1 / SPLIT} mm")


if __name__ == "__main__":
    main()
