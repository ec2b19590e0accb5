#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""A head turned by 15 degrees and resampled, segmented beside itself: Dice of tissues and hemispheres.

    Modules/Registration/benchmark/turned.py build/bin/explica T1 FOLDER [X,Y,Z mm ...] [--OPTION V ...]

Each voxel of the turned image is compared with the nearest one of the segmentation of the image as it
is.  "resampled" is what resampling alone costs: the shares of tissues found in the image as it is, resampled
as the brightness was, the largest taken, in the same comparison.  "beside these" compares with them
instead of the nearest voxels.  The last line is the same with the mask of the image as it is brought along
(1 where its resampled mask is 0.5 or more), so that what resampling blends with the zeros around a
stripped brain is not taken for brain.  Options go to every segmentation.  What is in FOLDER already is
used."""

import json
import pathlib
import subprocess
import sys

import nibabel as nib
import numpy as np
from scipy.ndimage import map_coordinates


def turn():
    """15 degrees about the axis from foot to head, 6 about that from left to right."""
    a, b = np.deg2rad(15), np.deg2rad(6)
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    return about_z @ about_x


def turned_grid(image, spacing):
    """Size and affine of a grid around the turned head, its motion (RAS mm), and the places of its
    voxels in the image."""
    voxels = np.argwhere(image.get_fdata() > 0)
    centre = nib.affines.apply_affine(image.affine, (voxels.min(0) + voxels.max(0)) / 2)
    shift = np.array([4.3, -7.1, 3.6])
    size = np.ceil(np.array([190, 230, 210]) / spacing).astype(int)
    affine = np.diag([*spacing, 1.0])
    affine[:3, 3] = shift - spacing * (size - 1) / 2
    motion = np.eye(4)
    motion[:3, :3] = turn()
    motion[:3, 3] = shift - turn() @ centre
    index = np.indices(size).reshape(3, -1).T
    back = np.linalg.inv(image.affine) @ np.linalg.inv(motion) @ affine
    return size, affine, motion, nib.affines.apply_affine(back, index).T


def resample(image, places, size, affine, file, order=1, kind=np.float32):
    """Writes the image's values at places (order 0: of the nearest voxels) on a grid, unless they are there."""
    if not file.exists():
        values = map_coordinates(np.asarray(image.dataobj), places, order=order, output=kind)
        nib.save(nib.Nifti1Image(values.reshape(size), affine), file)


def segmented(program, image, out, *options):
    if not (out / "summary.json").exists():
        subprocess.run([program, "segment", image, "--out", out, "--force", "--quiet", *options],
                       check=False)
    return out


def read(path):
    return np.asarray(nib.load(path).dataobj)


def dice(a, b):
    return 2 * np.count_nonzero(a & b) / (np.count_nonzero(a) + np.count_nonzero(b))


def compare(program, path, work, spacing, options):
    image = nib.load(path)
    size, affine, _, places = turned_grid(image, spacing)
    name = "turned-" + "x".join(f"{s:g}" for s in spacing)
    file = work / (name + ".nii.gz")
    resample(image, places, size, affine, file)
    plain = segmented(program, path, work / "plain", *options)
    turned = segmented(program, file, work / name, *options)

    nearest = np.round(places).astype(int)
    inside = np.all((nearest >= 0) & (nearest < np.array(image.shape)[:, None]), axis=0)
    nearest = np.where(inside, nearest, 0)

    def beside(volume):
        return np.where(inside, volume[tuple(nearest)], 0).reshape(size)

    known, found = beside(read(plain / "seg.nii.gz")), read(turned / "seg.nii.gz")
    shares = np.array([map_coordinates(read(plain / f"{k}.nii.gz").astype(np.float32), places, order=1)
                       for k in ("csf", "gm", "wm")])
    resampled = np.where(shares.sum(0) > 0.5, shares.argmax(0) + 1, 0).reshape(size)
    half_known, half = beside(read(plain / "hemisphere.nii.gz")), read(turned / "hemisphere.nii.gz")
    left, right = (2, 3), (41, 42)
    wrong = (np.isin(half, left) & np.isin(half_known, right)) | (
        np.isin(half, right) & np.isin(half_known, left))
    print(f"{name}: grey {dice(found == 2, known == 2):.3f} (resampled "
          f"{dice(resampled == 2, known == 2):.3f}), white {dice(found == 3, known == 3):.3f} (resampled "
          f"{dice(resampled == 3, known == 3):.3f}), grey and white "
          f"{dice(found >= 2, known >= 2):.3f}; hemispheres "
          + ", ".join(f"{dice(np.isin(half, s), np.isin(half_known, s)):.3f}" for s in (left, right))
          + f"; on the other side {100 * wrong.sum() / np.isin(half_known, left + right).sum():.2f} %")
    tell(f"{name}, beside these", turned, resampled, known)

    mask = work / (name + "-mask.nii.gz")
    if not mask.exists():
        inside = map_coordinates((image.get_fdata() > 0).astype(np.float32), places, order=1) >= 0.5
        nib.save(nib.Nifti1Image(inside.reshape(size).astype(np.uint8), affine), mask)
    masked = segmented(program, file, work / (name + "-masked"), "--mask", mask, "--template", "none",
                       *options)
    tell(f"{name}, mask brought along", masked, resampled, known)


def tell(title, made, resampled, known):
    """Tissues beside the shares resampled and the nearest voxels, and what the image was taken for."""
    found = read(made / "seg.nii.gz")
    numbers = json.loads((made / "summary.json").read_text())
    print(f"{title}: grey {dice(found == 2, resampled == 2):.3f}, white "
          f"{dice(found == 3, resampled == 3):.3f} (nearest voxels {dice(found == 2, known == 2):.3f}, "
          f"{dice(found == 3, known == 3):.3f}); brain {numbers['brain_volume_ml']:.0f} ml, means "
          + ", ".join(f"{numbers[k + '_mean']:.1f}" for k in ("csf", "grey", "white")))


def main():
    program, path, work = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    work.mkdir(parents=True, exist_ok=True)
    rest = sys.argv[4:]
    first = next((n for n, word in enumerate(rest) if word.startswith("--")), len(rest))
    for words in rest[:first] or ["0.8,0.8,0.8", "1,1,1", "1,1,2"]:
        spacing = np.array([float(w) for w in words.split(",")])
        compare(program, path, work, spacing, rest[first:])


if __name__ == "__main__":
    main()
