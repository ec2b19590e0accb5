# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Cortical thickness of a FreeSurfer subject, in every voxel of its ribbon.

    python3 thickness_of_subject.py SUBJECTS_DIR/bert --out bert

Writes thickness.nii.gz and thickness.png, and prints the mean beside the one that FreeSurfer found
on its surfaces.
"""

import argparse
import pathlib
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import nibabel
import numpy as np

import explica

WHITE = {"lh": 2, "rh": 41}
GREY = {"lh": 3, "rh": 42}


def freesurfer_mean(subject, hemisphere):
    """Mean thickness over FreeSurfer's surface, mm, or None if the subject has no statistics."""
    stats = subject / "stats" / f"{hemisphere}.aparc.stats"
    found = re.search(r"MeanThickness, .*?, ([\d.]+), mm", stats.read_text()) if stats.is_file() else None
    return float(found[1]) if found else None


def draw(brain, thickness, path):
    """One coronal slice through the thickest part of the ribbon, and the distribution."""
    inside = thickness > 0
    k = int(np.argmax(inside.sum(axis=(0, 1))))
    box = np.argwhere(inside[:, :, k])
    (i0, j0), (i1, j1) = box.min(axis=0) - 8, box.max(axis=0) + 8
    fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
    left.imshow(brain[i0:i1, j0:j1, k].T, cmap="gray", interpolation="nearest")
    shown = np.ma.masked_equal(thickness[i0:i1, j0:j1, k].T, 0)
    image = left.imshow(shown, cmap="viridis", vmin=0, vmax=5, interpolation="nearest")
    left.axis("off")
    fig.colorbar(image, ax=left, label="thickness, mm")
    right.hist(thickness[inside], bins=80, range=(0, 8), density=True, color="0.5")
    right.axvline(np.median(thickness[inside]), color="k", label="median")
    right.set(xlabel="thickness, mm", ylabel="density", xlim=(0, 8))
    right.legend()
    fig.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("subject", type=pathlib.Path, help="FreeSurfer subject directory")
    parser.add_argument("--hemisphere", choices=("lh", "rh"), default="lh")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("thickness"))
    arguments = parser.parse_args()
    if not (arguments.subject / "mri" / "ribbon.mgz").is_file():
        print("skipped: no real data")
        return

    side = arguments.hemisphere
    # Labels of the other hemisphere are no part of the tissue, and lie outside of it.
    ribbon = nibabel.load(arguments.subject / "mri" / "ribbon.mgz")
    result = explica.thickness(
        ribbon,
        inner=[WHITE[side]],
        tissue=[GREY[side]],
        progress=lambda share, what: print(f"\r{100 * share:3.0f} % {what:40}", end="", file=sys.stderr),
    )
    print(file=sys.stderr)

    arguments.out.mkdir(parents=True, exist_ok=True)
    nibabel.save(result["thickness"], arguments.out / "thickness.nii.gz")
    brain_file = arguments.subject / "mri" / "brain.mgz"
    brain = nibabel.load(brain_file if brain_file.is_file() else arguments.subject / "mri" / "ribbon.mgz")
    draw(
        np.asarray(brain.dataobj), np.asarray(result["thickness"].dataobj),
        arguments.out / "thickness.png",
    )  # fmt: skip
    summary = result["summary"]
    print(f"mean {summary['thickness_mean']:.2f} mm, median {summary['thickness_median']:.2f} mm "
          f"in {summary['voxels']} voxels")  # fmt: skip
    reference = freesurfer_mean(arguments.subject, side)
    if reference is not None:
        print(f"FreeSurfer: mean {reference:.2f} mm over its surface")


if __name__ == "__main__":
    main()
