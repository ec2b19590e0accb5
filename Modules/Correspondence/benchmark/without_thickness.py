#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Where the tissue voxels lie that have no thickness.

    without_thickness.py LABELS.nii.gz FOLDER [--tissue 2]

FOLDER is an output of `explica thickness LABELS.nii.gz`.  The voxels without thickness are put
together by faces and edges and corners (26 neighbours), and each such cluster is counted under the
first of these that holds: it is left out because it touches one boundary only; u does not differ
from 1 (or 0) there by more than 1e-6, so that there is no direction to follow; it lies within two
voxels of a recovered sulcus; the rest.  Prints for each the voxels, the clusters, the largest
cluster and, of the clusters, the mean share of their surface's faces that meet tissue with
thickness: what is joined by a neck has little.
"""
import argparse
import pathlib

import nibabel as nib
import numpy as np
from scipy import ndimage

FLAT = 1e-6  # of u, from which on no direction is left
NEAR = 2  # voxels to a recovered sulcus


def read(path):
    return np.squeeze(np.asarray(nib.load(path).dataobj))


def open_share(cluster, others):
    """Of the faces between a cluster and what lies around it, the share that meets `others`."""
    around = tissue = 0
    for axis in range(3):
        for step in (1, -1):
            beyond = np.roll(cluster, step, axis) & ~cluster
            around += beyond.sum()
            tissue += (beyond & others).sum()
    return tissue / max(around, 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("labels", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--tissue", type=int, default=2, help="its label")
    chosen = parser.parse_args()

    tissue = read(chosen.labels) == chosen.tissue
    u, thickness, sulci = (read(chosen.folder / f"{name}.nii.gz")
                           for name in ("harmonic", "thickness", "sulci"))
    missing = tissue & ~(thickness > 0)
    pieces, _ = ndimage.label(tissue)
    measured = np.unique(pieces[tissue & (thickness > 0)])
    beside = ndimage.distance_transform_edt(sulci == 0) <= NEAR
    clusters, count = ndimage.label(missing, np.ones((3, 3, 3)))
    kinds = {"touches one boundary only": [], "u is 1": [], "u is 0": [],
             f"within {NEAR} voxels of a recovered sulcus": [], "else": []}
    places = ndimage.find_objects(clusters)
    for number in range(1, count + 1):
        box = tuple(slice(max(s.start - 1, 0), s.stop + 1) for s in places[number - 1])
        here = clusters[box] == number
        values = u[box][here].astype(float)
        if not np.isin(pieces[box][here], measured).any():
            kind = "touches one boundary only"
        elif values.min() > 1 - FLAT:
            kind = "u is 1"
        elif values.max() < FLAT:
            kind = "u is 0"
        elif beside[box][here].all():
            kind = f"within {NEAR} voxels of a recovered sulcus"
        else:
            kind = "else"
        kinds[kind].append((here.sum(), open_share(here, tissue[box] & ~here), values.mean()))
    print(f"{missing.sum()} of {tissue.sum()} voxels have no thickness, in {count} clusters")
    for kind, found in kinds.items():
        if found:
            sizes, shares, levels = np.array(found).T
            print(f"{kind:40s} {sizes.sum():5.0f} voxels, {len(sizes):4d} clusters, largest "
                  f"{sizes.max():4.0f}, open {np.average(shares, weights=sizes):4.0%}, mean u "
                  f"{np.average(levels, weights=sizes):.6f}")


if __name__ == "__main__":
    main()
