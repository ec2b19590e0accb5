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
from scipy.ndimage import map_coordinates

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "Testing/validation"))
import measures  # noqa: E402
from harness import Explica, real  # noqa: E402
from turned import turned_grid  # noqa: E402


def turned_files(work, name, spacing):
    """The T1 (trilinear) and its parcellation (nearest voxels) on the turned grid, and the motion."""
    image = nib.load(real("bert_freesurfer", "mri", "brain.mgz"))
    atlas = nib.load(real("bert_freesurfer", "mri", "aparc+aseg.mgz"))
    size, affine, motion, places = turned_grid(image, spacing)
    for file, source, order, kind in ((work / f"{name}.nii.gz", image, 1, np.float32),
                                      (work / f"{name}-atlas.nii.gz", atlas, 0, np.int32)):
        values = map_coordinates(np.asarray(source.dataobj), places, order=order, output=kind)
        nib.save(nib.Nifti1Image(values.reshape(size), affine), file)
    return work / f"{name}.nii.gz", work / f"{name}-atlas.nii.gz", motion


def tell(name, made, side, motion):
    white = nib.load(made / "white.surf.gii")
    positions, faces = white.agg_data("pointset").astype(float), white.agg_data("triangle")
    thickness = nib.load(made / "thickness.shape.gii").darrays[0].data.astype(float)
    points, reference = measures.known_points(side)
    points = nib.affines.apply_affine(motion, points)
    apart, face = measures.nearest_faces(points, positions, faces)
    at = measures.at_points(points, positions, faces[face], thickness)
    known = at > 0
    theirs = measures.freesurfer_regions(side)
    a, b = np.array([(theirs[row["name"]], float(row["thickness_mean_mm"]))
                     for row in made.table("regions.tsv") if row["name"] in theirs]).T
    print(f"{name}, {side}h: points {apart.mean():.3f} mm off, thickness r "
          f"{np.corrcoef(at[known], reference[known])[0, 1]:.3f}, {(at - reference)[known].mean():+.3f} mm; "
          f"regions r {np.corrcoef(a, b)[0, 1]:.3f}, {(b - a).mean():+.3f} mm", flush=True)


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
            tell(name, made.step(f"surface-{side.upper()}"), side, motion)


main()
