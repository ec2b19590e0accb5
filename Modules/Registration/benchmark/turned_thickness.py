#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Cortical thickness of bert's T1, turned by 15 degrees and resampled, beside FreeSurfer's of bert as it is.

    Modules/Registration/benchmark/turned_thickness.py build/bin/explica FOLDER [X,Y,Z mm ...]

Runs segment, thickness and surface on the turned image; bert's parcellation, turned along (nearest
voxels), gives regions and sides only.  Of each hemisphere: how far the points of FreeSurfer's white
surface that its files state, turned along, lie from ours; correlation and mean difference of thickness
there; the same of the regions' means.  What is in FOLDER already is used."""

import pathlib
import sys

import nibabel as nib
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "Testing/validation"))
from harness import Explica, real  # noqa: E402
from measures import compare_with_freesurfer  # noqa: E402
from turned import resample, turned_grid  # noqa: E402


def turned_files(work, name, spacing):
    """The T1 (trilinear) and its parcellation (nearest voxels) on the turned grid, and the motion."""
    image = nib.load(real("bert_freesurfer", "mri", "brain.mgz"))
    atlas = nib.load(real("bert_freesurfer", "mri", "aparc+aseg.mgz"))
    size, affine, motion, places = turned_grid(image, spacing)
    resample(image, places, size, affine, work / f"{name}.nii.gz")
    resample(atlas, places, size, affine, work / f"{name}-atlas.nii.gz", 0, np.int32)
    return work / f"{name}.nii.gz", work / f"{name}-atlas.nii.gz", motion


def tell(on, found):
    r = [np.corrcoef(pair)[0, 1] for pair in (found.points, found.regions)]
    more = [(pair[0] - pair[1]).mean() for pair in (found.points, found.regions)]
    print(f"{on}: points {found.apart.mean():.3f} mm off, thickness r {r[0]:.3f}, {more[0]:+.3f} mm; "
          f"regions r {r[1]:.3f}, {more[1]:+.3f} mm", flush=True)


def main():
    work = pathlib.Path(sys.argv[2])
    work.mkdir(parents=True, exist_ok=True)
    explica = Explica(sys.argv[1], work)
    for words in sys.argv[3:] or ["0.8,0.8,0.8", "1,1,1", "1,1,2"]:
        name = "turned-" + words.replace(",", "x")
        image, atlas, motion = turned_files(work, name, np.array([float(w) for w in words.split(",")]))
        made = explica("run", image, "--atlas", atlas, "--steps", "segment,thickness,surface",
                       out=f"{name}-run", done=(0, 3))
        for side in "lr":
            tell(f"{name}, {side}h",
                 compare_with_freesurfer(made.step(f"surface-{side.upper()}"), side, motion))


main()
