#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What a viewer of one patch gets from a patch opened for them and from maps of the whole, on the same faces.

    Modules/Flattening/benchmark/compare_maps.py build/bin/explica DATA OUT [--only fsaverage5|s1]

DATA holds the folders fsaverage5 and s1_pycortex_lh.  For a patch of fsaverage5 left (40 mm) and one of S1 left (20 mm)
on the surface half way between white and pial, OUT gets the unfolded patch, its flat map, the surface inflated by
`explica inflate`, `explica compare` of these beside the flat, inflated and spherical surfaces that come with the data,
and a table for a page, table.md, which is printed, too.  What lies in OUT already is kept.
"""

import argparse
import csv
import pathlib
import subprocess

import nibabel
import numpy as np

SIDE = np.array([-1, 0.2, 0.2])  # the patch is about the vertex farthest that way, and seen from there
COLUMNS = [
    ("area_error_mean", "area error", "{:.1%}"),
    ("edge_strain_mean", "edge strain", "{:.1%}"),
    ("angle_error_mean_deg", "angle", "{:.1f} deg"),
    ("geodesic_error_local", "local", "{:.1%}"),
    ("geodesic_error_all", "all", "{:.1%}"),
    ("turned_over", "turned over", "{:.0f}"),
    ("crossings", "crossings", "{:.0f}"),
    ("seen", "seen", "{:.1%}"),
]


def middle(white, pial, out):
    """Writes the surface half way between two, and returns its positions."""
    inner, outer = nibabel.load(white), nibabel.load(pial)
    inner.darrays[0].data = ((inner.darrays[0].data + outer.darrays[0].data) / 2).astype("f4")
    nibabel.save(inner, out)
    return inner.darrays[0].data


def run(program, words, out):
    """Runs a command unless its results are there; exit code 3 leaves results, too."""
    if pathlib.Path(out, "summary.json").exists():
        return
    done = subprocess.run([program, *map(str, words), "--out", str(out), "--quiet"], check=False)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{words[0]} ended with {done.returncode}")


def compared(program, name, surfaces, given, radius, out):
    """The rows of one patch."""
    out.mkdir(parents=True, exist_ok=True)
    mid = out / "mid.surf.gii"
    positions = middle(*surfaces, mid)
    vertex = int(np.argmax((positions - positions.mean(axis=0)) @ SIDE))
    direction = ",".join(map(str, SIDE))
    words = ["unfold", mid, "--vertex", vertex, "--radius", radius, f"--direction={direction}", "--surround", "none"]
    run(program, words, out / "unfolded")
    run(program, ["flatten", out / "unfolded/unfolded.surf.gii"], out / "flat")
    run(program, ["inflate", mid], out / "inflated")
    ours = ["unfolded/unfolded.surf.gii", "flat/flat.surf.gii", "inflated/inflated.surf.gii"]
    files = [out / f for f in ours] + given
    run(program, ["compare", mid, *files], out / "compared")
    with open(out / "compared/comparison.tsv", encoding="utf-8") as table:
        rows = list(csv.DictReader(table, delimiter="\t"))
    for row in rows:
        values = [form.format(float(row[key])) for key, _, form in COLUMNS]
        yield "| " + " | ".join([name, f"`{row['surface']}`", *values]) + " |"
        name = ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--only", choices=["fsaverage5", "s1"])
    arguments = parser.parse_args()
    average, person = arguments.data / "fsaverage5", arguments.data / "s1_pycortex_lh"
    cases = {
        "fsaverage5": (
            "fsaverage5 left, 40 mm",
            [average / f"{s}_left.gii.gz" for s in ("white", "pial")],
            [average / f"{s}_left.gii.gz" for s in ("flat", "infl", "sphere")],
            40,
        ),
        "s1": (
            "S1 left, 20 mm",
            [person / f"{s}_lh.gii" for s in ("wm", "pia")],
            [person / f"{s}_lh.gii" for s in ("flat", "inflated")],
            20,
        ),
    }
    lines = ["| patch | surface | " + " | ".join(title for _, title, _ in COLUMNS) + " |"]
    lines.append("|---" * (len(COLUMNS) + 2) + "|")
    for key, case in cases.items():
        if arguments.only in (None, key):
            lines += compared(arguments.program, *case, arguments.out / key)
    text = "\n".join(lines) + "\n"
    (arguments.out / "table.md").write_text(text, encoding="utf-8")
    print(text, end="")


if __name__ == "__main__":
    main()
