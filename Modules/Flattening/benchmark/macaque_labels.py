#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Tissue labels of a macaque's hemispheres from the INIA19 template of Debian's mricron-data.

    Modules/Flattening/benchmark/macaque_labels.py OUT [--templates /usr/share/mricron/templates]

Writes OUT/seg_L.nii.gz and seg_R.nii.gz (1 around, 2 grey, 3 white and what is filled), for

    explica surface OUT/seg_L.nii.gz --white-label 3 --grey-label 2 --faces 80000 --out OUT/left

The template's label volume has a number a structure and no names: white matter of the lobes is 2, 55, 151 and 193 (+ 1000 on
the right); cortex is every other label most of which lies within 4 mm of it and is darker than white matter, but for the
deep nuclei and the cerebellum, listed here.  Deep structures above the temporal lobe are filled up to the midline.
"""

import argparse
import pathlib

import nibabel
import numpy as np
from scipy import ndimage

WHITE = [2, 55, 151, 193]
DEEP = [82, 97, 98, 148, 150, 162, 497, 500]
CEREBELLUM = [107, 228, 230, 237, 240, 242, 244, 245, 246, 253]
DARKER = 93  # mean brightness; white matter has 105 to 113, cortex 75 to 91
FEWEST = 250  # voxels of a cortical label


def cortical(labels, image, white):
    near = ndimage.binary_dilation(white, iterations=8)
    keys = []
    for key, count in zip(*np.unique(labels[labels > 0], return_counts=True)):
        if count < FEWEST or key in WHITE + DEEP + CEREBELLUM:
            continue
        voxels = labels == key
        if (voxels & near).sum() >= count / 2 and image[voxels].mean() <= DARKER:
            keys.append(key)
    return keys


def tissue(labels, image, places, side):
    white = np.isin(labels, WHITE)
    grey = np.isin(labels, cortical(labels, image, white))
    x, y, z = places
    deep = (labels > 0) & ~grey & ~white & ~np.isin(labels, CEREBELLUM) & (z > -6) & (y > -24)
    body = ndimage.binary_closing(np.pad(white | deep, 10), iterations=3)[10:-10, 10:-10, 10:-10]
    body &= ~grey & ((x < 0) if side < 0 else (x >= 0))
    body |= ndimage.binary_fill_holes(body | grey) & ~grey
    body = ndimage.binary_opening(body) | white
    pieces, count = ndimage.label(body)
    body = pieces == 1 + np.argmax(ndimage.sum(body, pieces, range(1, count + 1)))
    result = np.where(body, 3, np.where(grey, 2, 0)).astype("u1")
    result[(result == 0) & ndimage.binary_dilation(result > 0, iterations=6)] = 1
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--templates", type=pathlib.Path, default=pathlib.Path("/usr/share/mricron/templates"))
    words = parser.parse_args()
    words.out.mkdir(parents=True, exist_ok=True)
    maps = nibabel.load(words.templates / "inia19-NeuroMaps.nii.gz")
    labels = np.asarray(maps.dataobj).astype(int)
    image = np.asarray(nibabel.load(words.templates / "inia19-t1-brain.nii.gz").dataobj)
    affine = maps.affine
    places = [affine[k, k] * axis + affine[k, 3] for k, axis in enumerate(np.indices(labels.shape))]
    left = np.where(labels < 1000, labels, 0)
    right = np.where(labels >= 1000, labels - 1000, 0)
    for name, own, side in (("L", left, -1), ("R", right, 1)):
        seg = tissue(own, image, places, side)
        nibabel.save(nibabel.Nifti1Image(seg, affine), words.out / f"seg_{name}.nii.gz")
        volume = np.bincount(seg.ravel(), minlength=4) * abs(np.linalg.det(affine[:3, :3])) / 1000
        print(f"{name}: grey {volume[2]:.1f} ml, white and filled {volume[3]:.1f} ml")


if __name__ == "__main__":
    main()
