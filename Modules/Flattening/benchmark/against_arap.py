#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Flat maps of patches beside the best rigid map (ARAP, Liu et al. 2008) of the same faces.

    Modules/Flattening/benchmark/against_arap.py build/bin/explica DATA OUT [--only NAME]

DATA holds the folders fsaverage5, s1_pycortex_lh and bert_freesurfer.  Each patch is a ball about the vertex of the
surface half way between white and pial that lies farthest to the left and a little ahead and up.  ARAP starts at our
map and alternates local rotations and a global solve until its energy falls by less than 1e-7 of itself.  Writes and
prints table.md, with processor time of `explica flatten`; what lies in OUT already is kept.
"""

import argparse
import csv
import json
import pathlib
import resource
import subprocess

import nibabel
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.csgraph as csgraph
import scipy.sparse.linalg as linalg

SIDE = np.array([-1, 0.2, 0.2])


def arrays(path):
    return [array.data for array in nibabel.load(path).darrays]


def save(positions, like, path):
    image = nibabel.load(like)
    image.darrays[0].data = positions.astype("f4")
    nibabel.save(image, path)


def run(program, words, out):
    """Runs a command unless its results are there; returns its processor time in s."""
    note = out.with_suffix(".seconds")
    if not (out / "summary.json").exists():
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run([program, *map(str, words), "--out", str(out), "--quiet", "--force"], check=False)
        if done.returncode not in (0, 3):
            raise SystemExit(f"{words[0]} ended with {done.returncode}")
        note.write_text(f"{resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before:.1f}", encoding="utf-8")
    return float(note.read_text(encoding="utf-8"))


def ball(positions, faces, radius):
    """Vertices within the radius of the chosen one that hang together with it."""
    middle = int(np.argmax((positions - positions.mean(axis=0)) @ SIDE))
    near = np.linalg.norm(positions - positions[middle], axis=1) <= radius
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = edges[near[edges].all(axis=1)]
    graph = sparse.coo_matrix((np.ones(len(edges)), edges.T), (len(positions),) * 2)
    piece = csgraph.connected_components(graph, directed=False)[1]
    return np.flatnonzero(near & (piece == piece[middle]))


def unrolled(positions, faces):
    """Corners of each face in a plane of its own."""
    first, second = positions[faces[:, 1]] - positions[faces[:, 0]], positions[faces[:, 2]] - positions[faces[:, 0]]
    length = np.linalg.norm(first, axis=1)
    corners = np.zeros((len(faces), 3, 2))
    corners[:, 1, 0] = length
    corners[:, 2, 0] = (first * second).sum(axis=1) / length
    corners[:, 2, 1] = np.linalg.norm(np.cross(first, second), axis=1) / length
    return corners


def arap(positions, faces, flat):
    """The map that leaves each face as near to a rotation as can be."""
    rest, count = unrolled(positions, faces), len(positions)
    weights, rows, columns, entries = [], [], [], []
    for k in range(3):
        a, b = rest[:, k] - rest[:, (k + 2) % 3], rest[:, (k + 1) % 3] - rest[:, (k + 2) % 3]
        cotangent = (a * b).sum(axis=1) / (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        weights.append(np.clip(cotangent, -100, 100))
        i, j = faces[:, k], faces[:, (k + 1) % 3]
        rows += [i, j, i, j]
        columns += [i, j, j, i]
        entries += [weights[k], weights[k], -weights[k], -weights[k]]
    laplacian = sparse.csc_matrix((np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))))
    solver = linalg.splu(laplacian + sparse.csc_matrix(([1], ([0], [0])), shape=(count, count)))
    last = np.inf
    for _ in range(400):
        fits = np.zeros((len(faces), 2, 2))
        for k in range(3):
            now, was = flat[faces[:, (k + 1) % 3]] - flat[faces[:, k]], rest[:, (k + 1) % 3] - rest[:, k]
            fits += weights[k][:, None, None] * now[:, :, None] * was[:, None, :]
        angle = np.arctan2(fits[:, 1, 0] - fits[:, 0, 1], fits[:, 0, 0] + fits[:, 1, 1])
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]).transpose(2, 0, 1)
        energy, right = 0, np.zeros((count, 2))
        for k in range(3):
            wanted = np.einsum("fij,fj->fi", turn, rest[:, (k + 1) % 3] - rest[:, k])
            now = flat[faces[:, (k + 1) % 3]] - flat[faces[:, k]]
            energy += (weights[k] * ((now - wanted) ** 2).sum(axis=1)).sum()
            np.add.at(right, faces[:, (k + 1) % 3], weights[k][:, None] * wanted)
            np.add.at(right, faces[:, k], -weights[k][:, None] * wanted)
        right[0] += flat[0]
        flat = solver.solve(right)
        if last - energy < 1e-7 * energy:
            break
        last = energy
    return flat


def rows(program, name, mid, radius, out):
    positions, faces = arrays(mid)[:2]
    label = out / "region.label"
    vertices = ball(positions, faces, radius)
    lines = [f"{v} 0 0 0 0" for v in vertices]
    label.write_text(f"#!ascii label\n{len(lines)}\n" + "\n".join(lines) + "\n", encoding="utf-8")
    seconds = run(program, ["flatten", mid, "--label", label], out / "flat")
    rigid = out / "arap.surf.gii"
    if not rigid.exists():
        patch, patch_faces = arrays(out / "flat/patch.surf.gii")[:2]
        start = arrays(out / "flat/patch_flat.surf.gii")[0][:, :2].astype(float)
        of = arrays(out / "flat/vertex_of.shape.gii")[0].astype(int)
        whole = np.zeros_like(arrays(out / "flat/flat.surf.gii")[0])
        whole[of, :2] = arap(patch.astype(float), patch_faces, start)
        save(whole, out / "flat/flat.surf.gii", rigid)
    run(program, ["compare", mid, rigid, out / "flat/flat.surf.gii"], out / "compared")
    summary = json.loads((out / "flat/summary.json").read_text(encoding="utf-8"))
    with open(out / "compared/comparison.tsv", encoding="utf-8") as table:
        for row, what in zip(csv.DictReader(table, delimiter="\t"), ("ARAP", "`flatten`")):
            value = {key: float(text) for key, text in row.items() if key != "surface"}
            yield (
                f"| {name} | {summary['faces']:,} | {what} | {value['area_error_mean']:.1%} "
                f"| {value['edge_strain_mean']:.1%} "
                f"| {value['geodesic_error_local']:.2%} / {value['geodesic_error_all']:.2%} "
                f"| {value['turned_over']:.0f} | {value['crossings']:.0f} "
                f"| {seconds if what != 'ARAP' else ''} |"
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--only", help="patches whose name holds this")
    arguments = parser.parse_args()
    average, person = arguments.data / "fsaverage5", arguments.data / "s1_pycortex_lh"
    cases = [("fsaverage5 left", average / "white_left.gii.gz", average / "pial_left.gii.gz", (25, 40)),
             ("S1 left", person / "wm_lh.gii", person / "pia_lh.gii", (20, 40)),
             ("bert left", None, None, (25,))]  # fmt: skip
    lines = ["| patch | faces | map | area error | edge strain | local / all | turned over | crossings | s |", "|---" * 9 + "|"]
    for name, white, pial, radii in cases:
        for radius in radii:
            title = f"{name}, {radius} mm"
            if arguments.only and arguments.only not in title:
                continue
            out = arguments.out / title.replace(" ", "-").replace(",", "")
            out.mkdir(parents=True, exist_ok=True)
            mid = arguments.out / (name.replace(" ", "-") + ".surf.gii")
            if white is None:
                ribbon = arguments.data / "bert_freesurfer/mri/ribbon.mgz"
                run(arguments.program, ["surface", ribbon, "--preset", "ribbon", "--hemisphere", "L"], arguments.out / "bert")
                mid = arguments.out / "bert/mid.surf.gii"
            elif not mid.exists():
                save((arrays(white)[0] + arrays(pial)[0]) / 2, white, mid)
            lines += rows(arguments.program, title, mid, radius, out)
    text = "\n".join(lines) + "\n"
    (arguments.out / "table.md").write_text(text, encoding="utf-8")
    print(text, end="")


if __name__ == "__main__":
    main()
