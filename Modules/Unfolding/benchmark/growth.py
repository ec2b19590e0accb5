#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""How the time of whole unfoldings grows with the number of faces.

    Modules/Unfolding/benchmark/growth.py SURFACE --vertex I --direction=X,Y,Z --programs NEW [OLD]
        [--radii 8 12 20 28 40 60] [--surround none]

Prints a row for each radius as soon as it is done: faces, and for each program processor seconds of the whole command
(user and system), iterations, visibility, share seen, mean area error, mean edge strain, new crossings.  Then the
exponent of the least-squares line through the logarithms of faces and seconds, over all rows and between neighbours.
"""

import argparse
import json
import math
import pathlib
import resource
import subprocess
import tempfile


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def unfold(program, chosen, radius, out):
    """Processor seconds and summary of one whole command."""
    words = [program, "unfold", chosen.surface, "--vertex", str(chosen.vertex), "--radius", str(radius)]
    words += [f"--direction={chosen.direction}", "--surround", chosen.surround, "--out", out, "--force", "--quiet"]
    before = processor_seconds()
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)
    summary = json.loads(pathlib.Path(out, "summary.json").read_text(encoding="utf-8"))
    return processor_seconds() - before, summary


def exponent(faces, seconds):
    """Slope of the least-squares line through the logarithms."""
    x = [math.log(n) for n in faces]
    y = [math.log(t) for t in seconds]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def cells(seconds, s):
    return (
        f"{seconds:.2f} | {s['iterations']} | {s['visibility_final']:.3f}, {s['seen_final']:.3f} | "
        f"{100 * s['area_error_mean']:.2f} % | {100 * s['edge_strain_mean']:.1f} % | {s['self_intersections_new']}"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("surface")
    parser.add_argument("--vertex", type=int, required=True)
    parser.add_argument("--direction", required=True)
    parser.add_argument("--programs", nargs="+", required=True)
    parser.add_argument("--radii", type=float, nargs="+", default=[8, 12, 20, 28, 40, 60])
    parser.add_argument("--surround", default="none")
    chosen = parser.parse_args()
    faces, times = [], {program: [] for program in chosen.programs}
    with tempfile.TemporaryDirectory() as folder:
        for radius in chosen.radii:
            row = []
            for program in chosen.programs:
                seconds, summary = unfold(program, chosen, radius, folder + "/out")
                times[program].append(seconds)
                row.append(cells(seconds, summary))
            faces.append(summary["region_faces"])
            print(f"| {radius:g} mm | {faces[-1]:,} | " + " | ".join(row) + " |", flush=True)
    for program, seconds in times.items():
        steps = [exponent(faces[n : n + 2], seconds[n : n + 2]) for n in range(len(faces) - 1)]
        between = ", ".join(f"{step:.2f}" for step in steps)
        print(f"{program}: faces^{exponent(faces, seconds):.2f} over all, {between} between neighbours")


if __name__ == "__main__":
    main()
