# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Computes the numbers of an unfolding from its files, without any code of ours.  Usage: check_unfold.py SURFACE OUT

Prints each number of summary.json that the files do not give, and ends with 1 if there is one.  The surface to compare with is
the one that the summary names: SURFACE or OUT/reference.surf.gii.  A number that is neither computed here nor named in NOT_OF_FILES is
a fault as well."""

import json
import pathlib
import sys

import nibabel
import numpy as np
from scipy.spatial import cKDTree

surface, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
# What was given, what the machine took, and a mean over random sources along the surface.
NOT_OF_FILES = {"inputs_changed", "frames_not_stated", "viewpoint", "viewpoint_weights", "peak_memory_bytes"}


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


def crossings(points, faces):
    """Pairs of faces of which an edge of one passes through the other, away from a common vertex."""
    corners = points[faces]
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    near = cKDTree(centre).query_pairs(2 * radius.max(), output_type="ndarray")
    near = near[np.linalg.norm(centre[near[:, 0]] - centre[near[:, 1]], axis=1) <= radius[near].sum(axis=1)]
    found = set()
    for f, g in (near.T, near.T[::-1]):  # edges of f through g
        side, other = corners[g, 1] - corners[g, 0], corners[g, 2] - corners[g, 0]
        for k in range(3):
            origin, way = corners[f, k], corners[f, (k + 1) % 3] - corners[f, k]
            to = origin - corners[g, 0]
            p, q = np.cross(way, other), np.cross(to, side)
            with np.errstate(divide="ignore", invalid="ignore"):
                u, v, t = (x / (side * p).sum(axis=1) for x in ((to * p).sum(axis=1), (q * way).sum(axis=1), (other * q).sum(axis=1)))
                hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)
            ends = faces[f][:, [k, (k + 1) % 3]]
            hit &= ~(faces[g][:, :, None] == ends[:, None, :]).any(axis=(1, 2))
            found |= {(min(pair), max(pair)) for pair in zip(f[hit].tolist(), g[hit].tolist())}
    return found


def table(name):
    """Rows of a table, each a dictionary."""
    head, *rows = (line.split("\t") for line in (out / name).read_text(encoding="utf-8").splitlines())
    return [dict(zip(head, row)) for row in rows]


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
read_in = read(surface)[0]
moves = np.linalg.norm(before - read_in, axis=1)
again |= {"repair_vertices_moved": (moves > 0).sum(), "repair_move_max": moves.max(), "repair_move_mean": moves[moves > 0].mean() if moves.any() else 0}
crossing_rows = table("intersections.tsv")
start, reference, end = crossings(read_in, all_faces), crossings(before, all_faces), crossings(after, faces)
again |= {
    "self_intersections_initial": len(start),
    "self_intersections_initial_region": sum(inside[list(pair)].any() for pair in start),
    "self_intersections_repaired": len(start - reference),
    "self_intersections_final": len(end),
    "self_intersections_new": len(end - start),
}
evolution = table("evolution.tsv")
again |= {"iterations": int(evolution[-1]["iteration"]), "visibility_final": float(evolution[summary["iteration_written"]]["visibility"])}
of_evolution = again["visibility_final"] - summary["visibility_final"]
for name, points in (("initial", before), ("final", after)):
    cosine, size = cosines(points, region, eye)
    mean = (cosine * size).sum() / size.sum()
    again["visibility_" + name] = mean
    again["backfacing_" + name] = size[cosine < 0].sum() / size.sum()
if summary["surround"] != "none":  # nothing that moved crosses what stayed
    again["crossings_with_rest"] = sum((inside | collar)[list(pair)].any() for pair in end - start)
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
if abs(of_evolution) > 1e-5:
    faults.append(f"iteration_written: its visibility is {of_evolution:.6f} off")
if {(int(row["face_1"]), int(row["face_2"])) for row in crossing_rows} != start:
    faults.append("intersections.tsv: not the pairs that cross")
told = {"seen_initial", "seen_final", "real_visibility_initial", "real_visibility_final", "flux_variance_initial", "flux_variance_final"}
numbers = {key for key, value in summary.items() if isinstance(value, (int, float, list)) and not key.startswith("seconds")}
faults += [f"{key}: not computed" for key in sorted(numbers - again.keys() - told - NOT_OF_FILES - {"iteration_written", "reasons", "warnings"})]
print("\n".join(faults))
sys.exit(bool(faults))
