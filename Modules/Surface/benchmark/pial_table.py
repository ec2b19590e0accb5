#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""How even and how smooth outer surfaces are, one row each.

    pial_table.py SURFACE... [--image FILE]

SURFACE is any GIFTI surface.  Columns: share of edges with a dihedral angle above 60 degrees,
longest edge (mm), faces below 0.02 mm2, highest spike (mm: a vertex from the mean of its ring) and
roughness: how far a vertex stands above the mean of its ring, less what its neighbours do, median
over what bulges outward, mm.  With --image that of vertices within a voxel of where the image is
zero, as at the edge of a skull-stripped brain, stands apart.
"""
import argparse
import pathlib

import nibabel as nib
import numpy as np
from scipy.ndimage import map_coordinates, minimum_filter
from scipy.sparse import coo_matrix, diags

SMALL = 0.02  # mm2


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


def at_zero(image, points):
    """True where a voxel of the image is zero beside a point."""
    volume = nib.load(image)
    index = nib.affines.apply_affine(np.linalg.inv(volume.affine), points).T
    return map_coordinates(minimum_filter(volume.get_fdata(), 3), index, order=0) == 0


def row_of(path, image):
    mesh = Mesh(path)
    lengths, cosines = mesh.edges()
    heights, spikes = mesh.heights()
    rough = np.abs(heights - mesh.mean_of_ring @ heights)
    bulging = mesh.mean_of_ring @ (mesh.mean_of_ring @ heights) > 0
    text = (f"{(cosines < 0.5).mean():8.2%} {lengths.max():8.2f}"
            f" {(np.linalg.norm(mesh.crosses, axis=1) < 2 * SMALL).sum():7d} {spikes.max():7.2f}"
            f" {np.median(rough[bulging]):9.3f}")
    if image:
        zero = at_zero(image, mesh.points)
        text += (f"   beside zero ({zero.mean():.0%}) {np.median(rough[bulging & zero]):.3f},"
                 f" elsewhere {np.median(rough[bulging & ~zero]):.3f}")
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surfaces", nargs="+", type=pathlib.Path)
    parser.add_argument("--image")
    words = parser.parse_args()
    print("above 60  longest  small   spike  roughness")
    for path in words.surfaces:
        print(row_of(path, words.image), path)


if __name__ == "__main__":
    main()
