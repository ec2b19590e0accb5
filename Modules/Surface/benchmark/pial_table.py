#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""How even and how smooth outer surfaces are, one row each.

    pial_table.py SURFACE... [--image FILE] [--gaps]

SURFACE is any GIFTI surface.  Columns: share of edges with a dihedral angle above 60 degrees,
longest edge (mm), faces below 0.02 mm2, highest spike (mm: a vertex from the mean of its ring) and
roughness: how far a vertex stands above the mean of its ring, less what its neighbours do, median
over what bulges outward, mm.  With --image that of vertices within a voxel of where the image is
zero, as at the edge of a skull-stripped brain, stands apart.  With --gaps (half a minute each): how
near the surface comes to itself, mm, and the share of its faces that are nearer than 0.01 and 0.05
mm to one that is not their neighbour within two edges.
"""
import argparse
import pathlib

import nibabel as nib
import numpy as np
from scipy.ndimage import map_coordinates, minimum_filter
from scipy.sparse import coo_matrix, diags, identity

SMALL = 0.02  # mm2
REACH = 0.1  # mm within which faces are looked for
CELL = 1.5  # mm, of the lattice in which they are


class Mesh:
    def __init__(self, path):
        surface = nib.load(path)
        self.points = surface.agg_data("pointset").astype(float)
        self.faces = surface.agg_data("triangle")
        corners = self.points[self.faces]
        self.crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        count, (a, b, c) = len(self.points), self.faces.T
        ends = np.r_[a, b, c], np.r_[b, c, a]
        joined = coo_matrix((np.ones(len(ends[0])), ends), shape=(count, count)).tocsr()
        joined = ((joined + joined.T) > 0).astype(float)
        self.joined = joined
        self.mean_of_ring = diags(1 / np.maximum(np.asarray(joined.sum(axis=1)).ravel(), 1)) @ joined

    def edges(self):
        """Lengths of the edges, each once, and the cosines between the normals beside them."""
        rows = np.sort(np.vstack([self.faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        order = np.lexsort(rows.T)
        rows, face = rows[order], np.tile(np.arange(len(self.faces)), 3)[order]
        first = np.flatnonzero((rows[:-1] == rows[1:]).all(axis=1))
        normals = self.crosses / np.maximum(np.linalg.norm(self.crosses, axis=1), 1e-30)[:, None]
        along = self.points[rows[first, 0]] - self.points[rows[first, 1]]
        cosines = (normals[face[first]] * normals[face[first + 1]]).sum(axis=1)
        return np.linalg.norm(along, axis=1), cosines

    def heights(self):
        """Of vertices above the mean of their rings along their normals, mm; that vector's length."""
        normals = np.zeros_like(self.points)
        for k in range(3):
            np.add.at(normals, self.faces[:, k], self.crosses)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        off = self.points - self.mean_of_ring @ self.points
        return (off * normals).sum(axis=1), np.linalg.norm(off, axis=1)


    def gaps(self):
        """Distances between faces that are not neighbours within two edges, within REACH, and the
        pairs."""
        low, high = (end(self.points[self.faces], axis=1) + side * REACH / 2
                     for end, side in ((np.min, -1), (np.max, 1)))
        pairs = overlapping(low, high)
        near = identity(len(self.points)) + self.joined
        near = (near @ near).tocsr()
        far = np.ones(len(pairs), dtype=bool)
        for a in range(3):
            for b in range(3):
                ends = self.faces[pairs[:, 0], a], self.faces[pairs[:, 1], b]
                far &= np.asarray(near[ends]).ravel() == 0
        pairs = pairs[far]
        s, t = self.points[self.faces[pairs[:, 0]]], self.points[self.faces[pairs[:, 1]]]
        least = np.full(len(pairs), np.inf)
        for a in range(3):
            for b in range(3):
                least = np.minimum(least, between_segments(s[:, a], s[:, (a + 1) % 3], t[:, b],
                                                           t[:, (b + 1) % 3]))
            least = np.minimum(least, above_face(s[:, a], t))
            least = np.minimum(least, above_face(t[:, a], s))
        return least, pairs


def overlapping(low, high):
    """Pairs of boxes that overlap."""
    first, last = np.floor(low / CELL).astype(int), np.floor(high / CELL).astype(int)
    first, last = first - first.min(axis=0), last - first.min(axis=0)
    count, spans = last.max(axis=0) + 1, (last - first).max(axis=0) + 1
    rows, cells = [], []
    for step in np.ndindex(*spans):
        inside = np.flatnonzero((first + step <= last).all(axis=1))
        rows.append(inside)
        cells.append(np.ravel_multi_index((first[inside] + step).T, count))
    rows, cells = np.concatenate(rows), np.concatenate(cells)
    order = np.argsort(cells, kind="stable")
    rows, cells = rows[order], cells[order]
    found, live, ahead = [], np.arange(len(cells)), 1
    while len(live):
        live = live[live + ahead < len(cells)]
        live = live[cells[live] == cells[live + ahead]]
        a, b = rows[live], rows[live + ahead]
        meet = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
        found.append(np.sort(np.stack([a, b], axis=1)[meet], axis=1))
        ahead += 1
    return np.unique(np.concatenate(found), axis=0)


def between_segments(p, q, r, s):
    """Distances between segments p q and r s."""
    along, other, apart = q - p, s - r, p - r
    dot = lambda x, y: (x * y).sum(axis=1)
    a, b, e = dot(along, along), dot(along, other), dot(other, other)
    c, f = dot(along, apart), dot(other, apart)
    size = a * e - b * b
    at = np.where(size > 1e-14 * a * e, np.clip((b * f - c * e) / np.maximum(size, 1e-300), 0, 1), 0)
    free = (b * at + f) / np.maximum(e, 1e-300)
    to = np.clip(free, 0, 1)
    at = np.where(free == to, at, np.clip((b * to - c) / np.maximum(a, 1e-300), 0, 1))
    return np.linalg.norm(apart + at[:, None] * along - to[:, None] * other, axis=1)


def above_face(p, t):
    """Distance of points from the planes of faces (n x 3 x 3) where they lie above these."""
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    size = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    height = ((p - t[:, 0]) * normal).sum(axis=1) / size
    foot = p - (height / size)[:, None] * normal
    inside = np.ones(len(p), dtype=bool)
    for k in range(3):
        side = np.cross(t[:, (k + 1) % 3] - t[:, k], foot - t[:, k])
        inside &= (side * normal).sum(axis=1) >= 0
    return np.where(inside, np.abs(height), np.inf)


def at_zero(image, points):
    """True where a voxel of the image is zero beside a point."""
    volume = nib.load(image)
    index = nib.affines.apply_affine(np.linalg.inv(volume.affine), points).T
    return map_coordinates(minimum_filter(volume.get_fdata(), 3), index, order=0) == 0


def gap_text(mesh):
    least, pairs = mesh.gaps()
    share = [len(np.unique(pairs[least < limit])) / len(mesh.faces) for limit in (0.01, 0.05)]
    nearest = f"{least.min():8.1e}" if len(least) and least.min() < REACH else f"   > {REACH}"
    return f" {nearest} {share[0]:7.3%} {share[1]:7.3%}"


def row_of(path, image, gaps):
    mesh = Mesh(path)
    lengths, cosines = mesh.edges()
    heights, spikes = mesh.heights()
    rough = np.abs(heights - mesh.mean_of_ring @ heights)
    bulging = mesh.mean_of_ring @ (mesh.mean_of_ring @ heights) > 0
    text = (f"{(cosines < 0.5).mean():8.2%} {lengths.max():8.2f}"
            f" {(np.linalg.norm(mesh.crosses, axis=1) < 2 * SMALL).sum():7d} {spikes.max():7.2f}"
            f" {np.median(rough[bulging]):9.3f}")
    if gaps:
        text += gap_text(mesh)
    if image:
        zero = at_zero(image, mesh.points)
        text += (f"   beside zero ({zero.mean():.0%}) {np.median(rough[bulging & zero]):.3f},"
                 f" elsewhere {np.median(rough[bulging & ~zero]):.3f}")
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surfaces", nargs="+", type=pathlib.Path)
    parser.add_argument("--image")
    parser.add_argument("--gaps", action="store_true")
    words = parser.parse_args()
    print("above 60  longest  small   spike  roughness"
          + ("  nearest  < 0.01  < 0.05" if words.gaps else ""))
    for path in words.surfaces:
        print(row_of(path, words.image, words.gaps), path)


if __name__ == "__main__":
    main()
