# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Wall thickness of the left ventricle as a bull's-eye of 17 segments.

    python3 ventricle_bullseye.py                    # of a generated ventricle, beside the truth
    python3 ventricle_bullseye.py ED_label.nii.gz --insertion=-35.2,90.4,-46.4

Short-axis slices along the third axis, 3-D or 4-D.  The insertion is the point, RAS mm, where the
right ventricle's anterior wall joins the left one; where the right ventricle has a label it is not
needed.  Writes bullseye.png and segments.tsv.
"""

import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import nibabel
import numpy as np

import explica
from explica import phantoms

# Rings of segments from the outside in: inner and outer radius, the segments counter-clockwise from
# the one whose middle lies at `start` degrees (0 is right, 90 is up: anterior).
RINGS = (
    (0.75, 1.0, range(1, 7), 90, 60),
    (0.5, 0.75, range(7, 13), 90, 60),
    (0.25, 0.5, range(13, 17), 90, 90),
)


def draw_bullseye(ax, rows, title):
    """The segments' mean thickness in colours, numbers in mm."""
    means = {row["segment"]: row["thickness"] for row in rows}
    known = [m for m in means.values() if np.isfinite(m)]
    colour = plt.Normalize(min(known), max(known))
    places = [
        (segment, low, high, np.radians(start + n * width), np.radians(width))
        for low, high, segments, start, width in RINGS
        for n, segment in enumerate(segments)
    ]
    for segment, low, high, angle, width in [*places, (17, 0.0, 0.25, 0.0, 2 * np.pi)]:
        mean = means[segment]
        face = plt.cm.viridis(colour(mean)) if np.isfinite(mean) else "0.85"
        edge = 0 if segment == 17 else 2  # the apex is a whole disc: it has no seam
        ax.bar(angle, high - low, width, low, color=face, edgecolor="white", linewidth=edge)
        at = (0, 0) if segment == 17 else (angle, (low + high) / 2)
        light = np.isfinite(mean) and colour(mean) > 0.6
        text = f"{mean:.1f}" if np.isfinite(mean) else "-"
        ax.text(*at, text, ha="center", va="center", color="black" if light else "white")
    ax.set_axis_off()
    ax.set_title(title)
    return plt.cm.ScalarMappable(colour, "viridis")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("labels", nargs="?", type=pathlib.Path, help="label volume; default: a phantom")
    parser.add_argument("--insertion", help="X,Y,Z, RAS mm")
    parser.add_argument("--size", type=int, default=96, help="voxels a side of the phantom")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("bullseye"))
    arguments = parser.parse_args()

    options = {}
    truth = None
    if arguments.labels is None:
        made = phantoms.annulus("ventricle", size=arguments.size, spacing=120 / arguments.size)
        labels, affine = made["labels"], made["affine"]
        options = dict(cavity=1, wall=2, rv=made["label_names"]["right-ventricle"])
        truth = made["thickness"]
    elif not arguments.labels.is_file():
        print("skipped: no real data")
        return
    else:
        image = nibabel.load(arguments.labels)
        labels, affine = np.asarray(image.dataobj), image.affine
    if arguments.insertion is not None:
        options["rv_insertion"] = [float(x) for x in arguments.insertion.split(",")]

    result = explica.heart(labels, affine, **options)
    rows = [row for row in result["segments"] if row["frame"] == result["frame_ed"]]
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "segments.tsv").write_text(result["table"])
    fig, ax = plt.subplots(figsize=(6, 5.4), subplot_kw={"projection": "polar"}, layout="constrained")
    colours = draw_bullseye(ax, rows, "wall thickness (top: anterior)")
    fig.colorbar(colours, ax=ax, label="mm")
    fig.savefig(arguments.out / "bullseye.png", dpi=120)

    counted = result["thickness"][result["frame_ed"]] > 0
    for row in rows:
        line = f"{row['segment']:2} {row['name']:22} {row['thickness']:6.2f} mm"
        if truth is not None and row["voxels"]:
            here = truth[(result["segment_of"] == row["segment"]) & counted]
            line += f"   exact {len(here) / (1 / here).sum():6.2f} mm"  # the mean over columns
        print(line)


if __name__ == "__main__":
    main()
