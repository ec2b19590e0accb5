#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What changes when an option is set: each number lower and higher than its default, each choice and flag the other
way, on small data, one option at a time.

    Testing/validation/options.py [--program build/bin/explica] [--command unfold]... [--folder DIR] [--write]

A row an option and value: of how many subjects any byte of the outputs changes, and over all subjects the least and
largest change of each measure against the defaults'.  --write puts the tables into options/README.md.
Options that no row can judge (inputs, places, labels, limits) are listed with the reason in NOT_TRIED; an option that
is in neither ends the script with an error, so that a new one is thought about.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

from harness import DATA, ROOT

PAGE = pathlib.Path(__file__).parent / "options" / "README.md"
FACTOR = 4  # from the default to the lower and the higher value

SMALL = DATA / "fsaverage5" / "fsaverage3_fs_binary"
PIAL, WHITE = DATA / "fsaverage5" / "pial_left.gii.gz", DATA / "fsaverage5" / "white_left.gii.gz"
SIDE = ["--direction=-1,0.2,0.2"]
THESIS = ["--surround", "none", "--method", "thesis", "--knot", "tree", "--knot-weight", "0.2", "--max-iterations", "60"]

# Subjects of each command: name, inputs and words.  {folder} has the phantoms.
SUBJECTS = {
    "unfold": [
        ("25 mm", [str(PIAL), "--vertex", "4530", "--radius", "25", *SIDE]),
        ("insula", [str(PIAL), "--center=-37,3,-2", "--radius", "20", "--direction=-1,0,0"]),
        ("white pole", [str(WHITE), "--vertex", "7057", "--radius", "20", "--direction=-0.5,0.8,-0.4"]),
        ("cut out", [str(PIAL), "--vertex", "4530", "--radius", "25", *SIDE, "--surround", "none"]),
        ("fixed", [str(PIAL), "--vertex", "4530", "--radius", "25", *SIDE, "--surround", "fixed"]),
        ("thesis", [str(PIAL), "--vertex", "4530", "--radius", "20", *SIDE, *THESIS]),
    ],
    "flatten": [
        ("unfolded patch", ["{folder}/patch/unfolded.surf.gii", "--reference", str(PIAL)]),
        ("folded patch", [str(PIAL), "--label", "{folder}/patch/region.label.gii"]),
        ("cut hemisphere", [str(SMALL / "lh.white"), "--cuts", "auto"]),
    ],
    "inflate": [
        ("left pial", [str(SMALL / "lh.pial")]),
        ("left white", [str(SMALL / "lh.white")]),
        ("right white", [str(SMALL / "rh.white")]),
    ],
    "polygon": [
        ("19 edges", ["--phantom", "polygon19"]),
        ("34 edges", ["--phantom", "polygon34"]),
        ("elastic", ["--phantom", "polygon34", "--surround", "elastic"]),
        ("thesis", ["--phantom", "polygon19", "--method", "thesis", "--max-iterations", "2000"]),
    ],
    "repair": [
        ("right pial", [str(DATA / "fsaverage5" / "pial_right.gii.gz")]),
        ("right white", [str(DATA / "fsaverage5" / "white_right.gii.gz")]),
    ],
    "thickness": [
        ("spheroid", ["{folder}/spheroid/labels.nii.gz", "--inner", "1", "--tissue", "2"]),
        ("cortex", ["{folder}/cortex/labels.nii.gz", "--inner", "3", "--tissue", "2"]),
        ("levels", ["--inner-level", "{folder}/spheroid/inner_level.nii.gz", "--outer-level",
                    "{folder}/spheroid/outer_level.nii.gz"]),
    ],
    "surface": [
        ("cortex", ["{folder}/cortex/labels.nii.gz", "--faces", "6000"]),
        ("shell", ["{folder}/shell/labels.nii.gz", "--white-label", "1", "--grey-label", "2", "--faces", "3000"]),
    ],
    "segment": [
        ("cortex", ["{folder}/cortex/t1.nii.gz", "--template", "none", "--accept", "brain-volume"]),
        ("noisy", ["{folder}/noisy/t1.nii.gz", "--template", "none", "--accept", "brain-volume"]),
    ],
    "embed": [
        ("ring", ["{folder}/shell/labels.nii.gz", "--label-key", "1"]),
        ("folds", ["{folder}/cortex/labels.nii.gz", "--label-key", "3"]),
        ("closed surface", ["{folder}/sheets/white.surf.gii", "--order", "8", "--samples", "800"]),
    ],
    "compare": [
        ("white and pial", [str(SMALL / "lh.white"), str(SMALL / "lh.pial")]),
        ("unfolded patch", [str(PIAL), "{folder}/placed/unfolded.surf.gii",
                            "--label", "{folder}/placed/region.label.gii"]),
    ],
}
PHANTOMS = {
    "cortex": ["phantom", "cortex", "--size", "64", "--spacing", "1.5"],
    "noisy": ["phantom", "cortex", "--size", "64", "--spacing", "1.5", "--noise", "10", "--bias", "0.4"],
    "spheroid": ["phantom", "spheroid", "--size", "64", "--spacing", "2"],
    "shell": ["phantom", "shell", "--size", "40"],
    "patch": ["unfold", str(PIAL), "--vertex", "4530", "--radius", "25", *SIDE, "--surround", "none"],
    "placed": ["unfold", str(PIAL), "--vertex", "4530", "--radius", "25", *SIDE],
    "sheets": ["surface", "{folder}/shell/labels.nii.gz", "--white-label", "1", "--grey-label", "2", "--faces", "1000"],
}

# What is measured: heading, how it is shown, and where it comes from (result folder, its summary, the subject's words).
MEASURES = {
    "unfold": [("visibility", "{:+.4f}", "visibility_final"), ("seen", "{:+.4f}", "seen_final"),
               ("strain, %", "{:+.2f}", lambda s: 100 * s["edge_strain_mean"]),
               ("area error, %", "{:+.3f}", lambda s: 100 * s["area_error_mean"]),
               ("iterations", "{:+d}", "iterations")],
    "flatten": [("area error, %", "{:+.3f}", lambda s: 100 * s["area_error_mean"]),
                ("strain, %", "{:+.2f}", lambda s: 100 * s["edge_strain_mean"]),
                ("distances, %", "{:+.2f}", lambda s: 100 * s["geodesic_error_all"]),
                ("iterations", "{:+d}", "iterations")],
    "inflate": [("visibility", "{:+.4f}", "visibility_final"),
                ("strain, %", "{:+.2f}", lambda s: 100 * s["edge_strain_mean"]),
                ("area error, %", "{:+.3f}", lambda s: 100 * s["area_error_mean"]),
                ("iterations", "{:+d}", "iterations")],
    "polygon": [("visibility", "{:+.4f}", "visibility_final"), ("flux variance", "{:+.5f}", "flux_variance_final"),
                ("length error, %", "{:+.3f}", lambda s: 100 * (s["length_error_max"] or 0)),
                ("crossings", "{:+d}", "self_intersections_final"), ("iterations", "{:+d}", "iterations")],
    "repair": [("pairs left", "{:+d}", "pairs_after"), ("vertices moved", "{:+d}", "vertices_moved"),
               ("farthest, mm", "{:+.4f}", "move_max")],
    "thickness": [("mean, mm", "{:+.4f}", "thickness_mean"),
                  ("off exact, mm", "{:+.4f}", "off"), ("traced share", "{:+.3f}", "traced_fraction")],
    "surface": [("white, mm^2", "{:+.1f}", "area_white"), ("pial, mm^2", "{:+.1f}", "area_pial"),
                ("thickness, mm", "{:+.4f}", "thickness_mean"), ("crossings", "{:+d}", "self_intersections")],
    "segment": [("Dice grey", "{:+.4f}", "dice_2"), ("Dice white", "{:+.4f}", "dice_3"),
                ("iterations", "{:+d}", "iterations")],
    "embed": [("off, mm", "{:+.4f}", "distance_mean"), ("farthest, mm", "{:+.4f}", "distance_max"),
              ("coefficients", "{:+d}", "coefficients")],
    "compare": [("distances nearby, %", "{:+.2f}", lambda s: 100 * s["geodesic_error_local"]),
                ("all distances, %", "{:+.2f}", lambda s: 100 * s["geodesic_error_all"])],
}

# Values other than a quarter and four times the default.
VALUES = {
    "unfold": {"distance": [100, 10000], "cone": [],
               "target-visibility": [0.9, 0.99], "max-iterations": [10, 2000],
               "frames": [3], "knot": ["tree"]},  # the other two sum the same pairs, for minutes
    "flatten": {"cut.strain": [0.08, 0.2], "cut.most": [3, 48], "area-tolerance": [0.0025, 0.04], "frames": [3],
                "grid": [0.25, 2]},
    "inflate": {"target-seen": [0.9, 0.99], "max-iterations": [10, 1200], "frames": [3]},
    "polygon": {"target-visibility": [0.9, 0.9999], "max-iterations": [10, 80000], "frames": [3], "stages": [2, 12]},
    "repair": {"max-move": [0.05, 3]},
    "thickness": {"lambda": [0.2, 2], "cells": [3], "level": [-0.5, 0.5], "facing": [60, 140]},
    "surface": {"fluid": [0.5]},
    "segment": {"max-iterations": [5, 240], "smooth": [0, 0.4], "bias-width": [0, 12, 50]},
    "embed": {"order": [4, 32], "inner-radius": [3], "outer-radius": [60], "fit-start": [0.1, 0.9],
              "frames": [3], "cells": [24, 192]},
}

# Why an option is not tried here; by command and name, or by name alone.
INPUT, PLACE, SPECIES = "an input or its frame", "says what is looked at", "needs other data than these"
NOT_TRIED = {
    "surface-space": INPUT, "xform": INPUT, "frame": INPUT, "scale": INPUT, "level-inside": INPUT,
    "viewpoint": PLACE, "direction": PLACE, "view-weights": PLACE, "view-line": PLACE, "center": PLACE,
    "vertex": PLACE, "radius": PLACE, "metric": PLACE, "cone": PLACE, "label-key": PLACE, "above": PLACE,
    "repair": "needs a surface that crosses itself", "max-time": "a limit", "resume": "goes on with a run",
    "inner": PLACE, "tissue": PLACE, "outer": PLACE, "insulated": PLACE, "white-label": PLACE, "grey-label": PLACE,
    "fill": PLACE, "preset": PLACE, "hemisphere": PLACE, "no-fill": SPECIES, "core-depth": SPECIES,
    "stripped": SPECIES, "open-ends": SPECIES, "per-slice": SPECIES, "rv-insertion": PLACE, "rv-insertion-image-axis": PLACE,
    "surface level": INPUT, "close-edges": SPECIES,
    "nearest": INPUT, "depths": "more output",
    "phantom": INPUT, "label": INPUT, "slice": INPUT, "contour": INPUT, "edges": INPUT, "polygon smooth": INPUT,
    "polygon distance": PLACE, "region": PLACE,
    "fit": "another result", "average": "another result", "combine": "another result", "series": "another result",
    "centre": PLACE, "fs-volume": INPUT,
}


def described(program):
    said = json.loads(subprocess.run([program, "--describe"], check=True, capture_output=True, text=True).stdout)
    return {c["command"]: c["parameters"] for c in (said["commands"] if isinstance(said, dict) else said)}


def settings(command, parameters):
    """(option, shown value, words) of everything that is tried."""
    for p in parameters:
        name, default = p["name"], p["default"]
        if p["category"] == "Common" or p["positional"] or p["type"] == "text":
            continue
        if name in NOT_TRIED or f"{command} {name}" in NOT_TRIED:
            continue
        if p["type"] == "flag":
            yield name, "no" if default else "yes", [f"--no-{name}" if default else f"--{name}"]
            continue
        if p["type"] == "choice":
            values = VALUES.get(command, {}).get(name) or [c for c in p["choices"] if c != default]
        elif name in VALUES.get(command, {}):
            values = VALUES[command][name]
        elif isinstance(default, (int, float)) and default > 0:
            values = [default / FACTOR, default * FACTOR]
            if p["type"] == "integer":
                values = [max(1, int(v)) for v in values]
        else:
            sys.exit(f"{command} --{name}: give it values in VALUES, or a reason in NOT_TRIED")
        for value in values:
            yield name, f"{value:g}" if isinstance(value, float) else str(value), [f"--{name}", str(value)]


def dice(folder, truth):
    import nibabel
    found, exact = (nibabel.load(path).get_fdata() for path in (folder / "seg.nii.gz", truth))
    return {f"dice_{k}": 2 * ((found == k) & (exact == k)).sum() / ((found == k).sum() + (exact == k).sum())
            for k in (2, 3)}


def off_exact(folder, words):
    import nibabel
    import numpy
    mine = nibabel.load(folder / "thickness.nii.gz").get_fdata()
    if "cortex" in " ".join(words):
        return {"off": float(numpy.nanmean(numpy.abs(mine[mine > 0] - 2.5)))}
    exact = nibabel.load(pathlib.Path(words[0] if words[0][0] != "-" else words[1]).parent
                         / "thickness.nii.gz").get_fdata()
    both = (mine > 0) & (exact > 0)
    return {"off": float(numpy.abs(mine - exact)[both].mean())}


class Runs:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def phantoms(self):
        for name, words in PHANTOMS.items():
            if not (self.folder / name / "summary.json").exists():
                words = [w.replace("{folder}", str(self.folder)) for w in words]
                subprocess.run([self.program, *words, "--quiet", "--force", "--out", str(self.folder / name)],
                               check=True)

    def __call__(self, command, subject, words):
        """Measures, bytes of what was written (None: refused or stopped)."""
        words = [w.replace("{folder}", str(self.folder)) for w in words]
        out = self.folder / "out"
        done = subprocess.run([self.program, command, *words, "--threads", "1", "--quiet", "--force", "--out",
                               str(out)], stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode not in (0, 3):
            return None, done.stderr.strip().split("\n")[-1]
        summary = json.loads((out / "summary.json").read_text())
        if command == "segment":
            summary |= dice(out, pathlib.Path(words[0]).parent / "labels.nii.gz")
        if command == "thickness":
            summary |= off_exact(out, words)
        record = json.loads((out / "provenance.json").read_text())
        files = {o["path"]: o["sha256"] for o in record["outputs"] if not o["path"].endswith(".state")
                 and o["path"] not in ("summary.json", "evolution.tsv") and not o["path"].startswith("frames/")}
        values = [how(summary) if callable(how) else summary.get(how) for _, _, how in MEASURES[command]]
        return values, files


def span(shown, changes):
    changes = [c for c in changes if c is not None]
    if not changes:
        return ""
    low, high = (shown.format(c) for c in (min(changes), max(changes)))
    return low if low == high else f"{low} to {high}"


def same(default, now):
    """Files that both have are the same, byte by byte."""
    return all(now[name] == digest for name, digest in default.items() if name in now)


def table(runs, command, chosen):
    subjects = SUBJECTS[command]
    defaults = {name: runs(command, name, words) for name, words in subjects}
    for name, (values, said) in defaults.items():
        if values is None:
            sys.exit(f"{command}, {name}: {said}")
    heads = [head for head, _, _ in MEASURES[command]]
    rows = [f"| option | value | changes | {' | '.join(heads)} |", "|---" * (3 + len(heads)) + "|"]
    for option, value, extra in chosen:
        changed, refused, differences = [], [], [[] for _ in heads]
        for name, words in subjects:
            if extra[0] in words:  # the subject's own setting gives way
                at = words.index(extra[0])
                words = words[:at] + words[at + 2:]
            values, files = runs(command, name, [*words, *extra])
            if values is None:
                refused.append(name)
                continue
            before, whole = defaults[name]
            if not same(whole, files):
                changed.append(name)
            for list_, a, b in zip(differences, before, values):
                list_.append(b - a if a is not None and b is not None else None)
        tried = len(subjects) - len(refused)
        how = ("all " if len(changed) == tried > 1 else "") + str(len(changed)) + f" of {tried}"
        if 0 < len(changed) < tried:
            how += f": {', '.join(changed)}"
        cells = [span(shown, d) if changed else "" for (_, shown, _), d in zip(MEASURES[command], differences)]
        rows.append(f"| `--{option}` | {value} | {how} | {' | '.join(cells)} |")
        print(rows[-1], flush=True)
    return "\n".join(rows)


def write(command, text):
    page = PAGE.read_text()
    begin, end = f"<!-- options: {command} -->\n", "\n<!-- end -->"
    before, _, rest = page.partition(begin)
    PAGE.write_text(before + begin + text + end + rest.partition(end)[2])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/bin/explica"))
    parser.add_argument("--command", action="append", choices=sorted(SUBJECTS))
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("/tmp/explica-options"))
    parser.add_argument("--only", default="", help="options whose name matches this expression")
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    if given.only and given.write:
        parser.error("--write replaces whole tables, --only measures a part of one: give one of them")
    given.folder.mkdir(parents=True, exist_ok=True)
    runs = Runs(given.program, given.folder)
    runs.phantoms()
    commands = described(given.program)
    chosen = {command: list(settings(command, [p for p in commands[command] if re.search(given.only, p["name"])]))
              for command in given.command or SUBJECTS}
    if not any(chosen.values()):
        parser.error(f"--only {given.only}: no option that is tried has such a name")
    for command in (c for c in chosen if chosen[c]):
        text = table(runs, command, chosen[command])
        if given.write:
            write(command, text)


if __name__ == "__main__":
    main()
