# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of the page: SVG with neither time nor random names inside."""

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "explica", "svg.fonttype": "none", "font.size": 9,
                            "axes.spines.top": False, "axes.spines.right": False})

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "#777777"


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None, "Creator": None})
    plt.close(figure)


def errors_over_spacing(path, spacings, errors):
    """Error over voxel size, with the slope of second order beside it."""
    figure, axes = plt.subplots(figsize=(4.6, 3.2))
    for (name, values), colour in zip(errors.items(), (ORANGE, BLUE)):
        axes.loglog(spacings, values, "o-", color=colour, label=name)
    finest = min(values[-1] for values in errors.values())
    axes.loglog(spacings, [finest * (s / spacings[-1]) ** 2 for s in spacings], "--", color=GREY,
                label="second order")
    axes.set_xticks(spacings, [f"{s:g}" for s in spacings])
    axes.minorticks_off()
    axes.set_xlabel("voxel size [mm]")
    axes.set_ylabel("mean absolute error [mm]")
    axes.set_title("Thickness of a shell of 9.6 mm")
    axes.legend(frameon=False)
    save(figure, path)


def name_outliers(axes, names, x, y, off, count=3):
    for n in np.argsort(off)[-count:]:
        axes.annotate(names[n], (x[n], y[n]), textcoords="offset points", xytext=(4, 4),
                      fontsize=7, color=GREY)


def scatter_and_bland_altman(path, names, theirs, ours, title):
    """Regional means: one against the other, and their difference over their mean."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.6))
    low, high = min(theirs.min(), ours.min()) - 0.1, max(theirs.max(), ours.max()) + 0.1
    left.plot([low, high], [low, high], color=GREY, linewidth=0.8)
    left.scatter(theirs, ours, s=14, color=BLUE)
    name_outliers(left, names, theirs, ours, np.abs(ours - theirs))
    left.set(xlabel="FreeSurfer [mm]", ylabel="Explica [mm]", xlim=(low, high), ylim=(low, high),
             aspect="equal", title=f"r = {np.corrcoef(theirs, ours)[0, 1]:.3f}")
    difference, mean = ours - theirs, (ours + theirs) / 2
    right.scatter(mean, difference, s=14, color=BLUE)
    name_outliers(right, names, mean, difference, np.abs(difference - difference.mean()))
    for at, style in ((difference.mean(), "-"), (difference.mean() - 1.96 * difference.std(), "--"),
                      (difference.mean() + 1.96 * difference.std(), "--")):
        right.axhline(at, color=ORANGE, linestyle=style, linewidth=1)
        right.annotate(f"{at:+.2f}", (mean.max(), at), textcoords="offset points", xytext=(2, 3),
                       fontsize=7, color=ORANGE)
    right.set(xlabel="mean of both [mm]", ylabel="Explica - FreeSurfer [mm]",
              title="difference, its mean and 95 % range")
    figure.suptitle(f"Regional mean thickness: {title}")
    save(figure, path)


def map_errors(path, bars):
    """Distance errors of flat maps, ours beside the shipped ones."""
    figure, axes = plt.subplots(figsize=(6.4, 3.2))
    labels = []
    for n, (on, (ours, theirs)) in enumerate(bars.items()):
        for k, (key, what) in enumerate((("geodesic_error_local", "local"),
                                         ("geodesic_error_all", "all"))):
            at = 2.4 * n + k
            axes.bar(at - 0.18, 100 * float(ours[key]), 0.34, color=BLUE,
                     label="Explica" if at == 0 else None)
            axes.bar(at + 0.18, 100 * float(theirs[key]), 0.34, color=ORANGE,
                     label="FreeSurfer" if at == 0 else None)
            labels.append((at, f"{on.split(',')[0]}\n{what}"))
    axes.set_xticks(*map(list, zip(*labels)))
    axes.set_ylabel("distance error [%]")
    axes.legend(frameon=False)
    axes.set_title("Whole hemispheres in a plane, same cuts")
    save(figure, path)
