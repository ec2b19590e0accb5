#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Where a hemisphere's thickness is farthest from a reference, and what lies there.

    thickness_errors.py FOLDER POINTS [--share 0.02] [--clusters 20] [--regions]

FOLDER is an output of `explica surface`.  POINTS is bert's `?h.thickness_at_known_vertices.csv.gz`,
or a text file of x, y, z (RAS mm), thickness (mm) and perhaps curvature a line, as
labels_of_surfaces.py writes it.  Prints the agreement, the share of the squared errors by place
(crown, wall or floor of a sulcus; ending at fluid or between two banks), and the clusters of the
largest errors, each with the reference, ours, the straight way to the outer vertex and the nearest
distances both ways.  Correlation falls with the spread of what is correlated: the residual's SD
does not, and is printed beside it, with the correlation that it would give at a spread of 0.740 mm
(that of bert's left hemisphere).  With --regions, of a reference that knows regions, what each
region has of points and squared errors, and the correlation without it.
"""
import argparse
import pathlib

import nibabel as nib
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

COMMON_SPREAD = 0.740  # mm, at which hemispheres are compared
SULCUS = 0.1  # FreeSurfer's curvature beyond which a vertex is on a floor, below its negative a crown
SHORT = 0.3  # mm that an outer vertex lies from where its own trajectory's length would put it
NEAR = 1.5  # mm between points of one cluster


def reference(path):
    """Points (RAS mm), thickness (mm), curvature, region or None."""
    if path.name.endswith(".csv.gz"):
        table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
        table = table[table["thickness_mm"] > 0]
        points = np.stack([table[f"ras_{axis}"] for axis in "xyz"], axis=1)
        return points, table["thickness_mm"], table["curv"], table["aparc"]
    table = np.loadtxt(path)
    curvature = table[:, 4] if table.shape[1] > 4 else np.zeros(len(table))
    return table[:, :3], table[:, 3], curvature, None


class Hemisphere:
    """White and outer surface with what is known at their vertices."""

    def __init__(self, folder):
        white = nib.load(folder / "white.surf.gii")
        self.white = white.agg_data("pointset").astype(float)
        self.faces = white.agg_data("triangle")
        self.pial = nib.load(folder / "pial.surf.gii").agg_data("pointset").astype(float)
        maps = nib.load(folder / "thickness.shape.gii").darrays
        self.thickness, self.nearest = (m.data.astype(float) for m in maps[:2])
        self.straight = np.linalg.norm(self.pial - self.white, axis=1)
        self.outward = cKDTree(self.pial).query(self.white)[0]
        self.inward = cKDTree(self.white).query(self.pial)[0]

    def corners_at(self, points):
        """The face whose centre is nearest to each point, and its corners' weights."""
        _, face = cKDTree(self.white[self.faces].mean(axis=1)).query(points)
        corners = self.faces[face]
        weight = 1 / np.maximum(np.linalg.norm(self.white[corners] - points[:, None], axis=2), 1e-6)
        return corners, weight / weight.sum(axis=1, keepdims=True)


def print_agreement(name, ours, theirs):
    known = ours > 0
    off = (ours - theirs)[known]
    print(f"{name}: {known.sum()} points, r {np.corrcoef(ours[known], theirs[known])[0, 1]:.4f}, "
          f"|difference| {np.abs(off).mean():.3f} mm, mean {off.mean():+.3f} mm, "
          f"SD {ours[known].std():.3f} (reference {theirs[known].std():.3f})")
    slope, start = np.polyfit(theirs[known], ours[known], 1)
    left = (ours - start - slope * theirs)[known].std()
    spread = abs(slope) * COMMON_SPREAD
    print(f"  about the line of regression: SD {left:.3f} mm; of references that spread by "
          f"{COMMON_SPREAD:.3f} mm it would leave r {spread / np.hypot(spread, left):.4f}")


def print_places(off, curvature, slid, largest):
    total = (off**2).sum()
    print("place           points   squared errors   mean    SD     of the largest")
    for place, here in (("floor", curvature > SULCUS), ("wall", np.abs(curvature) <= SULCUS),
                        ("crown", curvature < -SULCUS)):
        for kind, those in (("", here & ~slid), (", slid", here & slid)):
            if not those.any():
                continue
            print(f"{place + kind:14s} {those.mean():7.1%} {(off[those]**2).sum() / total:12.1%}"
                  f" {off[those].mean():+11.3f} {off[those].std():7.3f} {(largest & those).sum():9d}")


def print_regions(ours, theirs, region):
    off, known = ours - theirs, ours > 0
    total = (off[known]**2).sum()
    rows = []
    for name in np.unique(region):
        here, rest = known & (region == name), known & (region != name)
        if not here.any() or not rest.any():
            continue
        rows.append(((off[here]**2).sum() / total,
                     f"{name:26s} {here.sum():6d} {here.sum() / known.sum():7.1%}"
                     f" {(off[here]**2).sum() / total:12.1%}"
                     f" {(off[here][off[here] < 0]**2).sum() / total:12.1%}"
                     f" {off[here].mean():+9.3f} {off[here].std():7.3f}"
                     f" {np.corrcoef(ours[rest], theirs[rest])[0, 1]:12.4f}"))
    print("region                     points           squared errors  of too thin     mean"
          "      SD   r without")
    for _, row in sorted(rows, reverse=True):
        print(row)


def clusters_of(points, chosen):
    rows = np.flatnonzero(chosen)
    pairs = cKDTree(points[rows]).query_pairs(NEAR, output_type="ndarray")
    joined = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(rows),) * 2)
    count, which = connected_components(joined, directed=False)
    return [rows[which == c] for c in range(count)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("points", type=pathlib.Path)
    parser.add_argument("--share", type=float, default=0.02, help="of the points, the farthest off")
    parser.add_argument("--clusters", type=int, default=20, help="to be listed")
    parser.add_argument("--regions", action="store_true", help="print a table of regions")
    chosen = parser.parse_args()

    made = Hemisphere(chosen.folder)
    points, theirs, curvature, region = reference(chosen.points)
    corners, weight = made.corners_at(points)
    at = {name: (weight * getattr(made, name)[corners]).sum(axis=1)
          for name in ("thickness", "nearest", "straight", "outward", "inward")}
    print_agreement("trajectories", at["thickness"], theirs)
    print_agreement("nearest distances both ways", at["nearest"], theirs)

    if chosen.regions and region is not None:
        print_regions(at["thickness"], theirs, region)

    off = at["thickness"] - theirs
    largest = np.abs(off) > np.quantile(np.abs(off), 1 - chosen.share)
    print(f"largest {chosen.share:.0%}: beyond {np.abs(off)[largest].min():.2f} mm, "
          f"{(off[largest]**2).sum() / (off**2).sum():.0%} of the squared errors, "
          f"{(off[largest] > 0).mean():.0%} of them too thick")
    print_places(off, curvature, at["straight"] > at["thickness"] + SHORT, largest)
    found = sorted(clusters_of(points, largest), key=lambda rows: -(off[rows]**2).sum())
    print(f"{len(found)} clusters; points, reference, ours, straight, outward, inward (mm), "
          "curvature, place (RAS mm)")
    for rows in found[:chosen.clusters]:
        means = [theirs[rows].mean()] + [at[name][rows].mean()
                                         for name in ("thickness", "straight", "outward", "inward")]
        place = ", ".join(f"{x:.0f}" for x in points[rows].mean(axis=0))
        print(f"{len(rows):4d}  " + "  ".join(f"{m:5.2f}" for m in means)
              + f"  {curvature[rows].mean():+.2f}  {place}")


if __name__ == "__main__":
    main()
