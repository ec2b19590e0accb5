# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Unfold a patch of a folded surface step by step, and plot how it goes.

    python3 unfold_patch.py                          # of a generated folded surface
    python3 unfold_patch.py lh.white.surf.gii --vertex 1000 --radius 20

Half way the viewpoint moves: the work goes on for the new one.  Writes unfolded.surf.gii,
evolution.png and patch.png (start, half way, end).
"""

import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import explica


def view_of(surface, region, faces):
    """A viewpoint 1 m away, in the direction in which the patch looks on the whole."""
    normal = explica.face_normals(surface)[faces].sum(axis=0)
    centre = surface[0][region].mean(axis=0)
    return centre + 1000 * normal / np.linalg.norm(normal)


def draw_patch(surface, region, viewpoint, title, ax):
    """The patch as the viewpoint sees it: faces from back to front, light where they face it."""
    towards = viewpoint - surface[0][region].mean(axis=0)
    towards = towards / np.linalg.norm(towards)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    axes = np.stack((right, np.cross(towards, right)), axis=1)
    faces = surface[1][np.isin(surface[1], region).all(axis=1)]
    corners = surface[0][faces]
    normals = explica.face_normals((surface[0], faces))
    light = normals @ towards / np.maximum(np.linalg.norm(normals, axis=1), 1e-12)
    order = np.argsort(corners.mean(axis=1) @ towards)
    colours = plt.get_cmap("copper")(0.15 + 0.85 * np.abs(light[order]))
    ax.add_collection(PolyCollection(list((corners @ axes)[order]), facecolors=colours))
    ax.autoscale()
    ax.set_aspect("equal")
    ax.set_title(title)
    ax.set_axis_off()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("surface", nargs="?", type=pathlib.Path)
    parser.add_argument("--vertex", type=int, help="the patch's centre; default: the leftmost one")
    parser.add_argument("--radius", type=float, default=12.0, help="mm")
    parser.add_argument("--levels", type=int, default=4, help="fineness of the generated surface")
    parser.add_argument("--steps", type=int, default=30, help="at most, for each viewpoint")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("unfolded"))
    arguments = parser.parse_args()

    if arguments.surface is None:
        positions, faces = explica.folded_sphere(arguments.levels, 30.0, 0.3, 8)
    elif not arguments.surface.is_file():
        print("skipped: no real data")
        return
    else:
        positions, faces = explica.read_surface(arguments.surface)
    vertex = int(np.argmin(positions[:, 0])) if arguments.vertex is None else arguments.vertex
    region = explica.select_region((positions, faces), vertex=vertex, radius=arguments.radius)
    patch = region["vertices"]
    viewpoint = view_of((positions, faces), patch, region["faces"])

    fig, axes = plt.subplots(1, 3, figsize=(12, 4.4), layout="constrained")
    draw_patch((positions, faces), patch, viewpoint, "start", axes[0])
    stepper = explica.Unfolder((positions, faces), patch, viewpoint)
    records = [stepper.record]
    turned = 0
    for stage in (1, 2):
        for _ in range(arguments.steps):
            if not stepper.step():
                break
            records.append(stepper.record)
        title = ("seen from the first viewpoint", "from the second")[stage - 1]
        draw_patch((stepper.positions, faces), patch, viewpoint, title, axes[stage])
        if stage == 1:
            turned = len(records) - 1
            aside = np.cross(viewpoint - positions[patch].mean(axis=0), [0.0, 0.0, 1.0])
            viewpoint = viewpoint + 0.5 * aside
            stepper.set_viewpoints(viewpoint)
    arguments.out.mkdir(parents=True, exist_ok=True)
    fig.savefig(arguments.out / "patch.png", dpi=100)

    fig, axes = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
    iterations = range(len(records))
    axes[0].plot(iterations, [r["visibility"] for r in records])
    axes[0].set(ylabel="average visibility")
    axes[1].semilogy(iterations, [max(r["area_error_mean"], 1e-6) for r in records], label="areas")
    axes[1].semilogy(iterations, [max(r["edge_strain_mean"], 1e-6) for r in records], label="edges")
    axes[1].set(ylabel="mean relative change")
    axes[1].legend()
    axes[2].plot(iterations, [r["contacts"] for r in records])
    axes[2].set(ylabel="pairs in contact range")
    for ax in axes:
        ax.axvline(turned, color="0.7", linestyle="--")
        ax.set_xlabel("iteration (dashed: the viewpoint moves)")
    fig.savefig(arguments.out / "evolution.png", dpi=100)

    done = (stepper.positions, faces)
    explica.write_surface(arguments.out / "unfolded.surf.gii", done)
    bent = explica.distortion((positions, faces), stepper.positions, region["faces"])
    print(f"visibility {records[0]['visibility']:.3f} -> {records[turned]['visibility']:.3f} "
          f"-> {records[-1]['visibility']:.3f} in {len(records) - 1} iterations")  # fmt: skip
    print(f"areas change by {100 * bent['area_error_mean']:.2f} %, edges by "
          f"{100 * bent['edge_strain_mean']:.1f} % on average")  # fmt: skip
    print(f"{len(explica.self_intersections(done))} pairs of faces intersect")


if __name__ == "__main__":
    main()
