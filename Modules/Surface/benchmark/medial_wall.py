#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What the medial wall does to the thickness of a region beside it.

    medial_wall.py FOLDER REGION SUBJECT SIDE

FOLDER is an output of `explica surface --atlas aparc+aseg.mgz`, SUBJECT FreeSurfer's folder of that
subject, SIDE lh or rh.  Prints FreeSurfer's thickness of the region's vertices, ours, and ours by
their distance to the nearest vertex without cortex, and apart those that lie on the corpus
callosum: white matter near the medial wall whose outward direction points up, at grey matter that
lies on it.  Labels say neither that this white matter bears no cortex nor where it ends.
"""
import argparse
import pathlib

import nibabel as nib
import numpy as np
from scipy.spatial import cKDTree

NEAR = 6  # mm from the medial wall
UP = 0.3  # share of the outward direction that points up
BINS = (0, 3, 5, 8, np.inf)  # mm


def line(what, thickness, area):
    if not area.sum() > 0:
        return
    low, middle, high = np.percentile(thickness, (5, 50, 95))
    print(f"{what:44s} {area.sum():5.0f} mm2, mean {np.average(thickness, weights=area):.2f} mm, "
          f"percentiles 5, 50, 95: {low:.2f}, {middle:.2f}, {high:.2f}")


def main():
    parser = argparse.ArgumentParser()
    for name in ("folder", "region", "subject", "side"):
        parser.add_argument(name)
    given = parser.parse_args()
    subject, folder = pathlib.Path(given.subject), pathlib.Path(given.folder)

    labels, _, names = nib.freesurfer.read_annot(subject / f"label/{given.side}.aparc.annot")
    theirs = labels == names.index(given.region.encode())
    morph = {name: nib.freesurfer.read_morph_data(subject / f"surf/{given.side}.{name}")[theirs]
             for name in ("thickness", "area")}
    line("FreeSurfer", morph["thickness"], morph["area"])

    def of(name):
        return nib.load(folder / f"{name}.gii")

    def values(name):
        return of(f"{name}.shape").darrays[0].data

    white, pial = (of(f"{name}.surf").agg_data("pointset").astype(float)
                   for name in ("white", "pial"))
    thickness, area, regions = values("thickness"), values("area"), of("regions.label")
    keys = [key for key, name in regions.labeltable.get_labels_as_dict().items()
            if name.endswith(given.region)]
    here = np.isin(regions.darrays[0].data, keys) & (thickness > 0)
    line("ours", thickness[here], area[here])
    wall = cKDTree(white[thickness <= 0]).query(white)[0]
    for low, high in zip(BINS, BINS[1:]):
        part = here & (wall >= low) & (wall < high)
        line(f"  {low} to {high} mm from the medial wall", thickness[part], area[part])
    outward = pial - white
    outward /= np.maximum(np.linalg.norm(outward, axis=1), 1e-9)[:, None]
    callosal = (wall < NEAR) & (outward[:, 2] > UP)
    line("  on the corpus callosum", thickness[here & callosal], area[here & callosal])
    line("  without these", thickness[here & ~callosal], area[here & ~callosal])


if __name__ == "__main__":
    main()
