# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Average shape of the outlines of a label in several slices of an image.

    python3 average_shape.py                         # of generated outlines
    python3 average_shape.py ED_label.nii.gz --label 1

Each outline becomes a harmonic function in a common annulus; coefficients are averaged.  Outlines
are moved to a common centre first.  Writes average.csv and average.png.
"""

import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import nibabel
import numpy as np

import explica
from explica import planar, shapes


def generated(count):
    """Ellipses with a dent at places that vary."""
    random = np.random.default_rng(7)
    outlines = []
    for _ in range(count):
        a, b = random.uniform(22, 30, 2)
        outline = planar.ellipse(160, a, b)
        angle = np.arctan2(outline[:, 1], outline[:, 0])
        dent = np.exp(-((np.angle(np.exp(1j * (angle - random.normal(0.8, 0.2)))) / 0.4) ** 2))
        outlines.append(outline * (1 - 0.25 * dent)[:, None])
    return outlines


def outlines_of(path, label):
    """The largest contour of the label in every slice that has one of at least 40 mm."""
    image = nibabel.load(path)
    labels = np.asarray(image.dataobj)
    found = []
    for k in np.flatnonzero((labels == label).any(axis=(0, 1))):
        curves, _ = planar.contours_of_label(image, label, slice=int(k))
        if planar.edge_lengths(curves[0]).sum() >= 40:
            found.append(planar.resample(curves[0], 160))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("labels", nargs="?", type=pathlib.Path)
    parser.add_argument("--label", type=int, default=1)
    parser.add_argument("--order", type=int, default=24, help="highest angular frequency")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("average"))
    arguments = parser.parse_args()

    if arguments.labels is None:
        outlines = generated(6)
    elif not arguments.labels.is_file():
        print("skipped: no real data")
        return
    else:
        outlines = outlines_of(arguments.labels, arguments.label)
    outlines = [outline - outline.mean(axis=0) for outline in outlines]

    start = shapes.around(outlines, order=arguments.order)
    fits = [shapes.fit(outline, start) for outline in outlines]
    mean = shapes.average(fit["shape"] for fit in fits)
    outline = mean.polygon()

    arguments.out.mkdir(parents=True, exist_ok=True)
    planar.write_polygon(arguments.out / "average.csv", outline)
    fig, ax = plt.subplots(figsize=(5.5, 5.5), layout="constrained")
    for one, fit in zip(outlines, fits):
        ax.fill(*one.T, facecolor="none", edgecolor="0.7", linewidth=1)
        ax.fill(*fit["shape"].polygon().T, facecolor="none", edgecolor="tab:blue", linewidth=0.6)
    ax.fill(*outline.T, facecolor="none", edgecolor="tab:red", linewidth=2.5)
    for radius in (mean.inner_radius, mean.outer_radius):
        ring = planar.circle(200, radius, mean.centre[:2])
        ax.fill(*ring.T, facecolor="none", edgecolor="0.5", linestyle=":")
    ax.set(aspect="equal", xlabel="mm", ylabel="mm", title="outlines, their fits, and the average")
    fig.savefig(arguments.out / "average.png", dpi=120)

    areas = [planar.signed_area(one) for one in outlines]
    distances = [shapes.distance(fit["shape"].polygon(), one)[0] for fit, one in zip(fits, outlines)]
    print(f"{len(outlines)} outlines of {min(areas):.0f} to {max(areas):.0f} mm^2; fits are "
          f"{np.mean(distances):.2f} mm off on average")  # fmt: skip
    print(f"average shape: {planar.signed_area(outline):.0f} mm^2, one closed curve for certain: "
          f"{mean.margin > 0}")  # fmt: skip


if __name__ == "__main__":
    main()
