# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Surfaces beside cortex that somebody has labelled by hand: how much of the one lies in the other.

    labelled_cortex.py LABELS SIDE SURFACES [SEGMENT]    one hemisphere of explica run: prints the shares

LABELS are cortical regions as FreeSurfer numbers them (1000 to 1999 left, 2000 to 2999 right), SIDE is L or R,
SURFACES the folder of explica surface.  With SEGMENT, the folder of explica segment, it tells at which stage labelled
cortex is lost: the class, the hemisphere, and then the surfaces.
"""

import json
import pathlib
import sys

import nibabel as nib
import numpy as np

FIRST = {"L": 1000, "R": 2000}
GREY, WHITE = {"L": 3, "R": 42}, {"L": 2, "R": 41}


def voxels_inside(positions, faces, affine, shape):
    """Which voxel centres a closed surface encloses: parity of its crossings along the grid's first axis.

    positions: #V x 3, RAS mm; returns booleans of that shape.
    """
    at = nib.affines.apply_affine(np.linalg.inv(affine), positions.astype(float))
    at[:, 1:] += 1e-5 * np.array([1.0, np.sqrt(2)])  # no ray meets an edge
    a, b, c = (at[faces[:, k]] for k in range(3))
    low = np.ceil(np.minimum(np.minimum(a, b), c)[:, 1:]).astype(int)
    high = np.floor(np.maximum(np.maximum(a, b), c)[:, 1:]).astype(int)
    crossings = np.zeros((shape[0] + 1, shape[1], shape[2]), dtype=np.int8)
    double = (b[:, 1] - a[:, 1]) * (c[:, 2] - a[:, 2]) - (b[:, 2] - a[:, 2]) * (c[:, 1] - a[:, 1])
    for j in range((high - low)[:, 0].max() + 1):
        for k in range((high - low)[:, 1].max() + 1):
            y, z = low[:, 0] + j, low[:, 1] + k
            with np.errstate(divide="ignore", invalid="ignore"):  # of triangles along the rays
                s = ((b[:, 1] - y) * (c[:, 2] - z) - (b[:, 2] - z) * (c[:, 1] - y)) / double
                t = ((c[:, 1] - y) * (a[:, 2] - z) - (c[:, 2] - z) * (a[:, 1] - y)) / double
                hit = (s >= 0) & (t >= 0) & (s + t <= 1)
            hit &= (y <= high[:, 0]) & (z <= high[:, 1])
            hit &= (y >= 0) & (y < shape[1]) & (z >= 0) & (z < shape[2])
            x = s[hit] * a[hit, 0] + t[hit] * b[hit, 0] + (1 - s - t)[hit] * c[hit, 0]
            at_voxel = np.clip(np.ceil(x), 0, shape[0]).astype(int)
            np.add.at(crossings, (at_voxel, y[hit], z[hit]), 1)
    return np.cumsum(crossings[:-1], axis=0) % 2 == 1


def surface_of(folder, name):
    image = nib.load(folder / f"{name}.surf.gii")
    return image.agg_data("pointset"), image.agg_data("triangle")


def areas_of(positions, faces):
    """Area at each vertex, mm^2."""
    t = positions[faces].astype(float)
    area = np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1) / 6
    return np.bincount(faces.ravel(), np.repeat(area, 3), len(positions))


def beside_labels(labels, side, surfaces):
    """Shares of one hemisphere: `middle`, the area of the middle surface (where there is cortex) that lies in
    labelled cortex; `between`, the labelled cortex between white and pial surface, by voxel centres; `beyond_pial`
    and `in_white`, the rest of it; `volume`, what lies between the surfaces over what is labelled; and `thickness`
    less that of the labels, volume over area of our middle surface, mm."""
    image = nib.load(labels)
    cortex = np.asarray(image.dataobj) // 1000 * 1000 == FIRST[side]
    white, pial = (voxels_inside(*surface_of(surfaces, name), image.affine, image.shape)
                   for name in ("white", "pial"))
    middle, faces = surface_of(surfaces, "mid")
    thickness = nib.load(surfaces / "thickness.shape.gii").darrays[0].data
    area = areas_of(middle, faces) * (thickness > 0)
    at = np.rint(nib.affines.apply_affine(np.linalg.inv(image.affine), middle)).astype(int)
    at = np.clip(at, 0, np.array(image.shape) - 1)
    voxel = abs(np.linalg.det(image.affine[:3, :3]))
    inside = cortex[tuple(at.T)]
    return {
        "middle": float(area[inside].sum() / area.sum()),
        "between": float((pial & ~white)[cortex].mean()),
        "beyond_pial": float((~pial)[cortex].mean()),
        "in_white": float((white & pial)[cortex].mean()),
        "volume": float((pial & ~white).sum() / cortex.sum()),
        "thickness": float((area * thickness).sum() / area.sum()
                           - cortex.sum() * voxel / area[inside].sum()),
    }


def stages(labels, side, segment):
    """Shares of labelled cortex in each class, and in the hemisphere's grey and white matter."""
    cortex = np.asarray(nib.load(labels).dataobj) // 1000 * 1000 == FIRST[side]
    tissue = np.asarray(nib.load(segment / "seg.nii.gz").dataobj)[cortex]
    ribbon = np.asarray(nib.load(segment / "hemisphere.nii.gz").dataobj)[cortex]
    grey, white = ((GREY[side], WHITE[side]) if (segment / "left").exists() else (2, 3))
    return {
        "class_fluid": float((tissue == 1).mean()), "class_grey": float((tissue == 2).mean()),
        "class_white": float((tissue == 3).mean()), "ribbon_grey": float((ribbon == grey).mean()),
        "ribbon_white": float((ribbon == white).mean()),
    }


def main():
    labels, side, surfaces = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    found = stages(labels, side, pathlib.Path(sys.argv[4])) if len(sys.argv) > 4 else {}
    print(json.dumps(found | beside_labels(labels, side, surfaces), indent=1))


if __name__ == "__main__":
    main()
