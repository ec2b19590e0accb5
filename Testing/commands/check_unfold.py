# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Computes the numbers of an unfolding from its files, without any code of ours.  Usage: check_unfold.py SURFACE OUT

Prints each number of summary.json that the files do not give, and ends with 1 if there is one.  The surface to compare with is
the one that the summary names: SURFACE or OUT/reference.surf.gii."""

import json
import pathlib
import sys

import nibabel
import numpy as np

surface, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))


def read(path):
    arrays = nibabel.load(path).darrays
    return arrays[0].data.astype(float), arrays[1].data


def vectors(points, faces):
    """Area times normal."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)


def angles(points, faces):
    corners = points[faces]
    found = []
    for k in range(3):
        u, v = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        found.append(np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1))))
    return np.array(found)


def cosines(points, faces, eye):
    area = vectors(points, faces)
    towards = eye - points[faces].mean(axis=1)
    size = np.linalg.norm(area, axis=1)
    return (area * towards).sum(axis=1) / np.linalg.norm(towards, axis=1) / size, size


def seen(points, faces, listed, eye):
    """Share of the area of the listed faces from whose middles no other face hides the eye [Moller and Trumbore 1997], and the
    same times the cosine."""
    cosine, size = cosines(points, faces[listed], eye)
    corner, side, other = points[faces[:, 0]], points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    free = real = 0.0
    for n in np.flatnonzero(cosine > 0):
        origin = points[faces[listed[n]]].mean(axis=0)
        way, to = eye - origin, origin - corner
        p, q = np.cross(way, other), np.cross(to, side)
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v, t = (to * p).sum(axis=1), q @ way, (other * q).sum(axis=1)
            u, v, t = (x / (side * p).sum(axis=1) for x in (u, v, t))
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (t < 1)
        hit[listed[n]] = False
        if not hit.any():
            free += size[n]
            real += size[n] * cosine[n]
    return free / size.sum(), real / size.sum()


def pieces_and_holes(faces):
    """Parts that share vertices, and loops of edges of a single face beyond one a part."""

    def parts(links):
        first = {}

        def root(v):
            while first.setdefault(v, v) != v:
                v = first[v]
            return v

        for link in links:
            for v in link[1:]:
                first[root(v)] = root(link[0])
        return len({root(v) for link in links for v in link})

    sides, uses = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0, return_counts=True)
    pieces = parts(faces.tolist())
    return pieces, parts(sides[uses == 1].tolist()) - pieces


before, all_faces = read(surface if summary["reference"] == "SURFACE" else out / summary["reference"])
after, faces = read(out / "unfolded.surf.gii")
inside = (nibabel.load(out / "region.label.gii").darrays[0].data == 1)[faces].all(axis=1)
collar = (before != after).any(axis=1)[faces].any(axis=1) & ~inside
region, eye = faces[inside], np.array(summary["viewpoint"])
size0, size1 = (np.linalg.norm(vectors(p, faces), axis=1) for p in (before, after))
ratio = size1 / size0
edges = np.unique(np.sort(np.concatenate([region[:, [0, 1]], region[:, [1, 2]], region[:, [2, 0]]]), axis=1), axis=0)
length0, length1 = (np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (before, after))
strain = np.abs(length1 / length0 - 1)
again = {
    "region_faces": inside.sum(),
    "region_vertices": len(np.unique(region)),
    "region_pieces": pieces_and_holes(region)[0],
    "region_holes": pieces_and_holes(region)[1],
    "region_area": size0[inside].sum(),
    "area_error_mean": np.abs(ratio[inside] - 1).mean(),
    "area_error_max": np.abs(ratio[inside] - 1).max(),
    "edge_strain_mean": strain.mean(),
    "edge_strain_p95": np.sort(strain)[int(0.95 * (len(strain) - 1))],
    "angle_error_mean_deg": np.abs(angles(after, region) - angles(before, region)).max(axis=0).mean(),
}
if collar.any():
    again |= {"collar_faces": collar.sum(), "collar_stretch_mean": ratio[collar].mean(), "collar_stretch_max": ratio[collar].max()}
for name, points in (("initial", before), ("final", after)):
    cosine, size = cosines(points, region, eye)
    mean = (cosine * size).sum() / size.sum()
    again["visibility_" + name] = mean
    again["backfacing_" + name] = size[cosine < 0].sum() / size.sum()
faults = [f"{key}: {summary[key]}, from the files {value:.6g}" for key, value in again.items() if abs(summary[key] - value) > 1e-5 * max(1, abs(value))]
for name, points in (("initial", before), ("final", after)):
    cosine, size = cosines(points, region, eye)
    variance = (cosine**2 * size).sum() / size.sum() - again["visibility_" + name] ** 2
    if abs(summary["flux_variance_" + name] - variance) > 1e-3:  # by the middles of the faces
        faults.append(f"flux_variance_{name}: {summary['flux_variance_' + name]}, from the files {variance:.5f}")
# One ray a face instead of nine: what lies at the edge of a shadow may differ.
for name, points in (("initial", before), ("final", after)):
    whole = all_faces if name == "initial" else faces
    listed = np.flatnonzero(inside) if len(whole) == len(inside) else None
    if listed is not None:
        for key, share in zip(("seen_", "real_visibility_"), seen(points, whole, listed, eye)):
            if abs(summary[key + name] - share) > 0.01:
                faults.append(f"{key}{name}: {summary[key + name]}, from the files {share:.4f}")
print("\n".join(faults))
sys.exit(bool(faults))
