# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""An image on a patch of cortex: its flat map at one depth, and its profile from white to pial.

    python3 flat_profile.py brain.mgz lh.white lh.pial --center -40 -20 50 --radius 20 --out patch

Without arguments a phantom is used whose values are known.  Writes patch.png and profile.tsv.
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
    """A shell with a bright middle layer and four sectors, its surfaces, and the exact values."""
    count, voxel, radii = 80, 0.8, (20.0, 28.0)
    affine = np.diag([voxel, voxel, voxel, 1.0])
    affine[:3, 3] = -0.5 * (count - 1) * voxel

    def value(at):
        x, y, z = np.moveaxis(at, -1, 0)
        depth = (np.sqrt(x**2 + y**2 + z**2) - radii[0]) / (radii[1] - radii[0])
        sectors = 0.5 * np.sin(2 * np.arctan2(y, x)) * (x**2 + y**2) / (x**2 + y**2 + z**2)
        return 1 + np.exp(-(((depth - 0.5) / 0.2) ** 2)) + sectors

    places = voxel * (np.moveaxis(np.indices((count,) * 3), 0, -1) - 0.5 * (count - 1))
    image = nibabel.Nifti1Image(value(places).astype("f4"), affine)
    return image, *(explica.icosphere(5, radius) for radius in radii), value


def patch_about(positions, faces, center, radius):
    """Faces within `radius` mm of the vertex nearest to `center`, as far as they hang together."""
    middle = np.argmin(np.linalg.norm(positions - center, axis=1))
    near = np.linalg.norm(positions - positions[middle], axis=1) < radius
    region = np.flatnonzero(near[faces].all(axis=1))
    piece = explica.face_components((positions, faces[region]))
    return region[piece == piece[(faces[region] == middle).any(axis=1)][0]]


def draw(flat, values, depths, mean, spread, exact, path):
    fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
    (u, v), faces = flat["positions"].T, flat["faces"]
    drawn = left.tripcolor(u, v, faces, values, shading="gouraud")
    left.plot([u.min(), u.min() + 10], [v.min() - 1] * 2, "k", linewidth=3)
    left.text(u.min() + 5, v.min() - 1.4, "10 mm", ha="center", va="top")
    left.set(aspect="equal", title="flat map, half way through the cortex")
    left.axis("off")
    fig.colorbar(drawn, ax=left, label="value")
    right.fill_between(depths, mean - spread, mean + spread, color="0.85", label="standard deviation")
    right.plot(depths, mean, "k", label="mean of the patch")
    if exact is not None:
        right.plot(depths, exact, "C1--", label="exact")
    right.set(xlabel="depth (0 white, 1 pial)", ylabel="value", xlim=(0, 1))
    right.legend(frameon=False)
    fig.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("image", nargs="?", help="image; with white and pial surface")
    parser.add_argument("white", nargs="?")
    parser.add_argument("pial", nargs="?")
    parser.add_argument("--center", nargs=3, type=float, default=[0, 0, 100], help="RAS mm")
    parser.add_argument("--radius", type=float, default=15, help="mm")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("patch"))
    arguments = parser.parse_args()
    value = None
    if arguments.image:
        image = nibabel.load(arguments.image)
        white, pial = (explica.read_surface(name) for name in (arguments.white, arguments.pial))
    else:
        image, white, pial, value = phantom()

    middle, faces = 0.5 * (white[0] + pial[0]), white[1]
    region = patch_about(middle, faces, arguments.center, arguments.radius)
    flat = explica.flatten((middle, faces), region=region)
    depths = np.linspace(0, 1, 21)
    values = explica.sample(image, white, pial, depths, interpolate="cubic")[:, flat["vertices"]]
    mean, spread = np.nanmean(values, axis=1), np.nanstd(values, axis=1)
    exact = None
    if value:
        way = pial[0] - white[0]
        places = (white[0] + depths[:, None, None] * way)[:, flat["vertices"]]
        exact = value(places).mean(axis=1)
        print(f"largest difference to the exact profile: {np.abs(mean - exact).max():.4f}")

    arguments.out.mkdir(parents=True, exist_ok=True)
    draw(flat, values[len(depths) // 2], depths, mean, spread, exact, arguments.out / "patch.png")
    table = np.column_stack([depths, mean, spread])
    np.savetxt(arguments.out / "profile.tsv", table, "%.6g", "\t", header="depth\tmean\tsd", comments="")
    print(f"{len(flat['vertices'])} vertices, {flat['turned_over']} faces turned over")


if __name__ == "__main__":
    main()
