#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Where the cuts lie that `explica flatten --cuts auto` has found, and how well those of several hemispheres agree.

    Modules/Flattening/benchmark/cut_places.py FOLDER... [--atlas VOLUME NAMES]...

Each FOLDER is a result of `explica flatten`.  A place is given by the shares of the hemisphere's box at which it lies: from
the back (0) to the front (1), from below (0) to the top (1), and from the middle of the brain (0) outwards (1), so that
hemispheres of two sides, people or kinds can be compared.  Each cut's end is followed by its length and, with an atlas in
the surface's space (one for all folders, or one each; NAMES: lines of "key name ..."), the regions that it runs along.  At
the end the cuts of each folder are matched with those of the first, the nearest ends first.
"""

import argparse
import csv
import json
import pathlib
from collections import Counter

import nibabel
import numpy as np


def read_names(path):
    names = {}
    for line in open(path, errors="replace"):
        words = line.split()
        if len(words) > 1 and words[0].isdigit():
            names[int(words[0])] = words[1]
    return names


def regions_along(points, volume, names):
    """The commonest regions within 3 mm of the points, with their shares."""
    labels = np.asarray(volume.dataobj)
    inverse = np.linalg.inv(volume.affine)
    offsets = np.array([[x, y, z] for x in (-3, 0, 3) for y in (-3, 0, 3) for z in (-3, 0, 3)])
    offsets = offsets[np.argsort((offsets**2).sum(1), kind="stable")]
    counts = Counter()
    for point in points:
        for offset in offsets:
            at = np.rint(inverse[:3, :3] @ (point + offset) + inverse[:3, 3]).astype(int)
            if np.any(at < 0) or np.any(at >= labels.shape[:3]):
                continue
            name = names.get(int(labels[tuple(at)]), "")
            if name and "White" not in name and "WM" not in name:
                counts[name] += 1
                break
    total = max(1, sum(counts.values()))
    return ", ".join(f"{name} {100 * n // total} %" for name, n in counts.most_common(4))


def cuts_of(folder, atlas):
    record = json.load(open(folder / "provenance.json"))
    surface = nibabel.load(next(i["absolute"] for i in record["execution"]["inputs"] if i["role"] == "SURFACE"))
    positions = surface.darrays[0].data.astype(float)
    labels = nibabel.load(folder / "cuts.label.gii").darrays[0].data
    low, high = positions.min(0), positions.max(0)
    right = abs(high[0]) > abs(low[0])
    cuts = []
    for n, row in enumerate(csv.DictReader(open(folder / "cuts.tsv"), delimiter="\t")):
        place = (positions[int(row["to"])] - low) / (high - low)
        share = np.array([place[1], place[2], place[0] if right else 1 - place[0]])
        along = positions[labels == n + 2]
        cuts.append((share, float(row["length"]), float(row["depth"]), regions_along(along, *atlas) if atlas else ""))
    return cuts, high - low


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--atlas", nargs=2, action="append", default=[])
    words = parser.parse_args()
    atlases = [(nibabel.load(volume), read_names(names)) for volume, names in words.atlas]
    first = None
    for n, folder in enumerate(words.folders):
        atlas = atlases[min(n, len(atlases) - 1)] if atlases else None
        cuts, box = cuts_of(folder, atlas)
        print(f"{folder.name}: {len(cuts)} cuts, {sum(c[1] for c in cuts):.0f} mm")
        for k, (share, length, depth, regions) in enumerate(cuts):
            print(f"  {k + 1}: front {share[0]:.2f} top {share[1]:.2f} out {share[2]:.2f}; {length:.0f} mm, {depth:.1f} sd; {regions}")
        if first is None:
            first = cuts
            continue
        # The box of a human hemisphere, so that shares become millimetres that can be compared.
        human = np.array([175, 120, 70])
        pairs = sorted((np.linalg.norm((a[0] - b[0]) * human), i, j) for i, a in enumerate(first) for j, b in enumerate(cuts))
        taken, rows = (set(), set()), []
        for d, i, j in pairs:
            if i in taken[0] or j in taken[1]:
                continue
            taken[0].add(i)
            taken[1].add(j)
            rows.append(f"{i + 1}-{j + 1} {d:.0f} mm")
        print("  ends beside the first folder's:", "; ".join(rows))


if __name__ == "__main__":
    main()
