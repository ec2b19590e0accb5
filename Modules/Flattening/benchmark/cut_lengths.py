#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""How long the cuts of a hemisphere's flat map are, by hand or by the program, by one measure.

    Modules/Flattening/benchmark/cut_lengths.py SURFACE MAP [--mouth MM]

SURFACE is the closed surface, MAP a flat map with its vertices, or a folder that `explica flatten --cuts` wrote.  Cuts made
by hand are strips of faces that are left out, and hang together with the medial wall.  The wall is what of the faces left
out holds a vertex that is more than MOUTH (8 mm) within them, and all within MOUTH of such a vertex; the rest are strips.
A bank is a piece of the rim on strips: it runs out and back, so that half of its length is that of the cut.  A folder of
`explica flatten` knows its cuts: their sum is printed beside.  Distances run along edges of the surface.
"""

import argparse
import csv
import heapq
import pathlib

import nibabel
import numpy as np


def read(path):
    data = nibabel.load(path).darrays
    return data[0].data.astype(float), data[1].data.astype(int)


def distances(neighbours, starts, within):
    """Along edges, over vertices `within` only."""
    away = {v: 0.0 for v in starts}
    queue = [(0.0, v) for v in starts]
    heapq.heapify(queue)
    while queue:
        d, v = heapq.heappop(queue)
        if d > away[v]:
            continue
        for w, length in neighbours[v]:
            if within[w] and d + length < away.get(w, np.inf):
                away[w] = d + length
                heapq.heappush(queue, (d + length, w))
    return away


def edges_of(faces):
    return np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def kept_faces(faces, flat_faces):
    have = {tuple(sorted(f)) for f in flat_faces.tolist()}
    return np.array([tuple(sorted(f)) in have for f in faces.tolist()])


def rim_of(faces):
    """Directed edges of one face only."""
    directed = {tuple(e) for e in edges_of(faces).tolist()}
    return [(a, b) for a, b in directed if (b, a) not in directed]


def banks_of(rim, is_wall):
    """Pieces of the rim that do not lie on the wall: lists of directed edges that hang together."""
    following = dict(rim)
    strips = {e for e in rim if not (is_wall[e[0]] and is_wall[e[1]])}
    before = {b: a for a, b in rim}
    banks = []
    while strips:
        a, b = next(iter(strips))
        while (before[a], a) in strips and before[a] != b:
            a, b = before[a], a
        bank = []
        while (a, b) in strips:
            strips.discard((a, b))
            bank.append((a, b))
            a, b = b, following[b]
        banks.append(bank)
    return banks


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("surface")
    parser.add_argument("map")
    parser.add_argument("--mouth", type=float, default=8)
    words = parser.parse_args()
    positions, faces = read(words.surface)
    folder = pathlib.Path(words.map)
    if folder.is_dir():
        with open(folder / "cuts.tsv") as table:
            rows = list(csv.DictReader(table, delimiter="\t"))
        lengths = [float(row["length"]) for row in rows]
        print(f"{folder}: {len(rows)} cuts, {sum(lengths):.0f} mm: " + ", ".join(f"{x:.0f}" for x in lengths))
        return
    kept = kept_faces(faces, read(words.map)[1])
    neighbours = [[] for _ in positions]
    for a, b in np.unique(np.sort(edges_of(faces)), axis=0):
        length = np.linalg.norm(positions[a] - positions[b])
        neighbours[a].append((b, length))
        neighbours[b].append((a, length))
    on_kept = np.zeros(len(positions), bool)
    on_kept[faces[kept]] = True
    off = np.zeros(len(positions), bool)
    off[faces[~kept]] = True
    rim = rim_of(faces[kept])
    depth = distances(neighbours, sorted({v for e in rim for v in e}), off)
    deep = [v for v, d in depth.items() if d > words.mouth and not on_kept[v]]
    near = distances(neighbours, deep, off)
    is_wall = np.zeros(len(positions), bool)
    is_wall[[v for v, d in near.items() if d <= 1.25 * words.mouth]] = True
    corner = positions[faces[~kept]]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum() / 2
    long = lambda edges: sum(np.linalg.norm(positions[a] - positions[b]) for a, b in edges)
    banks = [bank for bank in banks_of(rim, is_wall) if long(bank) > 40]  # cuts of 20 mm and more
    lengths = sorted((long(bank) / 2 for bank in banks), reverse=True)
    print(f"{words.map}: {len(banks)} cuts, {sum(lengths):.0f} mm: " + ", ".join(f"{x:.0f}" for x in lengths)
          + f"; rim {long(rim):.0f} mm, left out {area:.0f} mm2")


if __name__ == "__main__":
    main()
