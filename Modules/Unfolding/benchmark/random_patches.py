#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Unfolds random patches of surfaces with default options and says what became of them.

    Modules/Unfolding/benchmark/random_patches.py build/bin/explica SURFACE.gii... [--count N] [--seed S]
        [-- --surround fixed | --method thesis ...]

Each patch has its centre at a random vertex, a radius of 10 to 25 mm, and is seen from outside.  Prints how many ended
with which flag or were refused, how many with a new crossing had no flag, crossings that were not there before, crossings
with the surroundings, and the median and the tenth percentile of visibility and share seen.  What stands after `--`
goes to every unfolding.
"""

import argparse
import collections
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import nibabel
import numpy as np


def unfold(program, surface, positions, chosen, out, more):
    """The summary of one unfolding, or None if it was refused."""
    vertex = chosen.randrange(len(positions))
    towards = ",".join(f"{x:.6f}" for x in positions[vertex] - positions.mean(axis=0))
    radius = chosen.choice([10, 15, 20, 25])
    words = [program, "unfold", surface, "--vertex", str(vertex), "--radius", str(radius)]
    words += [f"--direction={towards}", "--out", out, "--force", "--quiet", *more]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        return None
    return json.loads(pathlib.Path(out, "summary.json").read_text(encoding="utf-8"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("surfaces", nargs="+")
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=7)
    given = sys.argv[1:]
    cut = given.index("--") if "--" in given else len(given)
    arguments, more = parser.parse_args(given[:cut]), given[cut + 1 :]
    chosen = random.Random(arguments.seed)
    positions = {path: nibabel.load(path).darrays[0].data for path in arguments.surfaces}
    ends, results = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(arguments.count):
            surface = chosen.choice(arguments.surfaces)
            summary = unfold(arguments.program, surface, positions[surface], chosen, folder + "/u", more)
            ends["refused" if summary is None else summary["flag"] or "opened"] += 1
            if summary:
                results.append(summary)
    print(dict(ends))
    print("crossings unsaid", sum(r["self_intersections_new"] > 0 and not r["flag"] for r in results))
    for key in ("self_intersections_new", "crossings_with_rest"):
        print(key, sum(r[key] for r in results))
    for key in ("visibility_final", "seen_final"):
        values = [r[key] for r in results]
        print(f"{key}: median {np.median(values):.3f}, tenth percentile {np.percentile(values, 10):.3f}")


if __name__ == "__main__":
    main()
