#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What a patch's lengths have to pay for its being seen: the front of mean edge strain against visibility.

    Modules/Unfolding/benchmark/pareto.py build/bin/explica SURFACE (--vertex I | --center=X,Y,Z) --radius R
        --direction=X,Y,Z [--surround none] [--targets 0.965 ...] [--trades 1 ...]
        [-- further words of explica unfold]

Unfolds the patch once for each target visibility and once for each trade, areas kept; free of its surroundings unless
told otherwise.  Prints a row for each run, then the front: of the runs that nothing beats in both
visibility and strain, the numbers, and by how much the nearest misses the goal of 0.98 and 9 %.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

GOAL = (0.98, 0.09)  # visibility at least, strain at most
KEPT = 0.002  # mean area error at most


def unfold(chosen, more, aim, out):
    """The summary of one unfolding, or None if it was refused."""
    words = [chosen.program, "unfold", chosen.surface, "--radius", chosen.radius, "--direction=" + chosen.direction]
    words += ["--vertex", chosen.vertex] if chosen.vertex else ["--center=" + chosen.center]
    words += ["--surround", chosen.surround, *aim, "--out", out, "--force", "--quiet", *more]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        return None
    return json.loads(pathlib.Path(out, "summary.json").read_text(encoding="utf-8"))


def front(points):
    """Those that no other beats: visibility falling, strain falling."""
    best, kept = float("inf"), []
    for point in sorted(points, key=lambda p: (-p[0], p[1])):
        if point[1] < best:
            best = point[1]
            kept.append(point)
    return kept


def lacks(point):
    """What is missing, 2 % of strain counting as 0.01 of visibility."""
    return max(GOAL[0] - point[0], (point[1] - GOAL[1]) / 2)


def main():
    given = sys.argv[1:]
    cut = given.index("--") if "--" in given else len(given)
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("surface")
    parser.add_argument("--vertex")
    parser.add_argument("--center")
    parser.add_argument("--radius", required=True)
    parser.add_argument("--direction", required=True)
    parser.add_argument("--surround", default="none")
    parser.add_argument("--targets", type=float, nargs="+", default=[0.965, 0.97, 0.975, 0.9785, 0.98, 0.985])
    parser.add_argument("--trades", type=float, nargs="+", default=[0.5, 1, 2, 4, 8])
    chosen, more = parser.parse_args(given[:cut]), given[cut + 1 :]
    points = []
    with tempfile.TemporaryDirectory() as folder:
        for aim in [("--target-visibility", str(t)) for t in chosen.targets] + [("--trade", str(t)) for t in chosen.trades]:
            summary = unfold(chosen, more, aim, folder + "/u")
            if summary is None or summary["area_error_mean"] > KEPT:
                continue
            points.append((summary["visibility_final"], summary["edge_strain_mean"], " ".join(aim)))
            print(f"{points[-1][2]}: {points[-1][0]:.4f}, {100 * points[-1][1]:.2f} %", flush=True)
    if not points:
        raise SystemExit("no run kept its areas")
    print("visibility, strain of the front:")
    for visibility, strain, aim in front(points):
        print(f"{visibility:.4f}, {100 * strain:.2f} % ({aim})")
    nearest = min(points, key=lacks)
    print(f"nearest to the goal: {nearest[0]:.4f}, {100 * nearest[1]:.2f} %, lacking {max(0, lacks(nearest)):.4f}")


if __name__ == "__main__":
    main()
