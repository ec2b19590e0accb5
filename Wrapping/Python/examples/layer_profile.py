# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The depth profile of an image in the cortex, from white matter to the pial surface.

    python3 layer_profile.py brain.mgz lh.white lh.pial --out profile

Without arguments a phantom is sampled whose profile is known.  Writes profile.png and profile.tsv.
"""

import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import nibabel
import numpy as np

import explica


def phantom():
    """A shell whose values peak in the middle layer, its surfaces, and the exact profile."""
    count, voxel, radii = 80, 0.8, (20.0, 28.0)
    affine = np.diag([voxel, voxel, voxel, 1.0])
    affine[:3, 3] = -0.5 * (count - 1) * voxel
    r = np.linalg.norm(voxel * (np.indices((count,) * 3) - 0.5 * (count - 1)), axis=0)
    depth = (r - radii[0]) / (radii[1] - radii[0])
    profile = lambda d: 1 + np.exp(-(((d - 0.5) / 0.2) ** 2))  # noqa: E731
    image = nibabel.Nifti1Image(profile(depth).astype("f4"), affine)
    return image, *(explica.icosphere(5, radius) for radius in radii), profile


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("image", nargs="?", help="image; with white and pial surface")
    parser.add_argument("white", nargs="?")
    parser.add_argument("pial", nargs="?")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("profile"))
    arguments = parser.parse_args()
    exact = None
    if arguments.image:
        image, white, pial = nibabel.load(arguments.image), arguments.white, arguments.pial
    else:
        image, white, pial, exact = phantom()

    depths = np.linspace(0, 1, 21)
    values = explica.sample(image, white, pial, depths, interpolate="cubic")
    mean = np.nanmean(values, axis=1)
    low, high = np.nanpercentile(values, 25, axis=1), np.nanpercentile(values, 75, axis=1)

    arguments.out.mkdir(parents=True, exist_ok=True)
    fig, axes = plt.subplots(figsize=(5, 4), layout="constrained")
    axes.fill_between(depths, low, high, color="0.85", label="middle half of the vertices")
    axes.plot(depths, mean, "k", label="mean")
    if exact:
        axes.plot(depths, exact(depths), "C1--", label="exact")
        print(f"largest difference to the exact profile: {np.abs(mean - exact(depths)).max():.4f}")
    axes.set(xlabel="depth (0 white, 1 pial)", ylabel="value", xlim=(0, 1))
    axes.legend(frameon=False)
    fig.savefig(arguments.out / "profile.png", dpi=120)
    table = np.column_stack([depths, mean, low, high])
    np.savetxt(arguments.out / "profile.tsv", table, "%.6g", "\t", header="depth\tmean\tp25\tp75", comments="")
    known = np.isfinite(values).mean()
    print(f"{values.shape[1]} vertices, {100 * known:.1f} % of the values known")


if __name__ == "__main__":
    main()
