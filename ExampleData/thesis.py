# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Runs the thesis's simulations and writes them as one page; see thesis.sh."""

import argparse
import base64
import html
import io
import itertools
import json
import math
import shutil
import subprocess
import sys
import time
from pathlib import Path

import matplotlib.figure
import nibabel
import numpy

import thesis_figures
import thesis_flows


class Work:
    """Runs explica into folders of one place and keeps what it said."""

    def __init__(self, explica, out, given=()):
        self.explica, self.out, self.commands = explica, out, {}
        self.folders = [f"{out / 'runs'}/", *(f"{folder}/" for folder in given)]

    def run(self, name, *words, may_stop=True):
        folder = self.out / "runs" / name
        shutil.rmtree(folder, ignore_errors=True)
        command = [str(w) for w in words]
        done = subprocess.run([self.explica, *command, "--out", folder, "--quiet"],
                              capture_output=True, text=True)
        if done.returncode not in ((0, 3) if may_stop else (0,)):
            raise SystemExit(f"explica {' '.join(command)}: exit {done.returncode}\n{done.stderr}")
        line = "explica " + " ".join(command)
        for prefix in self.folders:
            line = line.replace(prefix, "")
        self.commands[name] = line
        summary = json.loads((folder / "summary.json").read_text())
        summary["exit"] = done.returncode
        return summary

    def path(self, name):
        return self.out / "runs" / name

    def picture(self, target, *words):
        path = self.out / "runs" / target
        done = subprocess.run([self.explica, "view", *map(str, words), "--screenshot", str(path)],
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"explica view {words}: {done.stderr}")
        return path


# ---- figures ------------------------------------------------------------------------------------

def chart_of(series, x_label, y_label, y_log=True):
    """Lines with marks; series: list of (name, colour, [(x, y)]).  Infinite x stand at the right."""
    figure = matplotlib.figure.Figure(figsize=(5.6, 3.6), layout="tight")
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log" if y_log else "linear", xlabel=x_label, ylabel=y_label)
    finite = [x for _, _, points in series for x, _ in points if math.isfinite(x)]
    beyond = 2 * max(finite)
    for (name, colour, points), mark in zip(series, "osD^"):
        axes.plot([min(x, beyond) for x, _ in points], [y for _, y in points], f"{mark}-", color=colour, label=name)
    if any(math.isinf(x) for _, _, points in series for x, _ in points):
        axes.set_xticks([*sorted(set(finite)), beyond], [*(f"{x:g}" for x in sorted(set(finite))), "∞"])
        axes.set_xticks([], minor=True)
    axes.grid(color="#e4e6e8")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False)
    drawn = io.BytesIO()
    figure.savefig(drawn, format="svg")
    return f'<img alt="{html.escape(y_label)}" src="data:image/svg+xml;base64,{base64.b64encode(drawn.getvalue()).decode()}">'


class Page:
    """Sections with figures and numbers; every figure of the thesis is named once."""

    def __init__(self):
        self.body, self.numbers, self.figures, self.contents = [], [], {}, []

    def section(self, title):
        self.contents.append(title)
        self.body.append(f'<h2 id="s{len(self.contents)}">{html.escape(title)}</h2>')

    def text(self, words):
        self.body.append(f"<p>{words}</p>")

    def figure(self, numbers, caption, *pictures, command=None, wide=False):
        """numbers: the thesis's figures that this one is, "3.4"; pictures: paths or SVG text."""
        for number in numbers:
            self.figures[number] = "made"
        named = ", ".join(numbers)
        inner = []
        for picture in pictures:
            if isinstance(picture, str):
                inner.append(picture)
                continue
            data = Path(picture).read_bytes()
            kind = {".svg": "image/svg+xml", ".png": "image/png", ".gif": "image/gif"}[Path(picture).suffix]
            alt = html.escape(f"figure {named}: {caption}", quote=True)
            inner.append(f'<img alt="{alt}" src="data:{kind};base64,{base64.b64encode(data).decode()}">')
        line = f"<code>{html.escape(command)}</code>" if command else ""
        anchor = f' id="f{numbers[0]}"' if numbers else ""
        head = f"<b>Figure {named}.</b> " if numbers else ""
        self.body.append(f'<figure{anchor}{" class=wide" if wide else ""}><div>{"".join(inner)}</div>'
                         f"<figcaption>{head}{caption}{line}</figcaption></figure>")

    def not_made(self, numbers, why):
        for number in numbers:
            self.figures[number] = "not made"
        self.body.append(f"<p class=note><b>Figure {', '.join(numbers)}</b> is not made anew: {why}</p>")

    def table(self, head, rows):
        cells = "".join(f"<th>{h}</th>" for h in head)
        lines = "".join("<tr>" + "".join(f"<td>{c}</td>" for c in row) + "</tr>" for row in rows)
        self.body.append(f"<div class=scroll><table><tr>{cells}</tr>{lines}</table></div>")

    def number(self, key, what, thesis, ours, shown, where):
        """A number beside the thesis's; `ours` is what a test bounds, `shown` its format or a text."""
        self.numbers.append({"key": key, "what": what, "thesis": thesis, "ours": ours, "shown": shown.format(ours),
                             "figure": where})

    def write(self, out, seconds):
        (out / "thesis.json").write_text(json.dumps(
            {"numbers": self.numbers, "figures": self.figures, "seconds": seconds}, indent=1))
        rows = "".join(
            f"<tr><td>{html.escape(n['what'])}</td><td>{html.escape(n['thesis'])}</td>"
            f"<td>{html.escape(n['shown'])}</td><td><a href='#f{n['figure']}'>{n['figure']}</a></td></tr>"
            for n in self.numbers)
        contents = "".join(f'<li><a href="#s{k + 1}">{html.escape(t)}</a></li>'
                           for k, t in enumerate(self.contents))
        made = [f for f, state in self.figures.items() if state == "made"]
        text = f"""<!doctype html><html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>The thesis, figure by figure</title><style>
body {{ font: 16px/1.5 sans-serif; color: #1a1d21; max-width: 1180px; margin: 2em auto; padding: 0 1em }}
h2 {{ margin-top: 2.2em; border-bottom: 1px solid #ccd0d4 }}
figure {{ margin: 1.4em 0 }} figure div {{ display: flex; flex-wrap: wrap; gap: 10px; overflow-x: auto }}
figure img, figure svg {{ max-width: 100%; height: auto }}
figcaption {{ color: #3c434a; font-size: 15px; max-width: 60em }}
figcaption code {{ display: block; margin-top: 4px; font-size: 13px; overflow-wrap: anywhere }}
code {{ background: #f1f3f5; padding: 1px 5px; border-radius: 3px }}
table {{ border-collapse: collapse; font-size: 15px }} td, th {{ border: 1px solid #d5d9dd; padding: 3px 9px; text-align: left }}
th {{ background: #f1f3f5 }} .note {{ background: #fbf6e6; border-left: 4px solid #d9b84a; padding: 6px 12px }}
.scroll {{ overflow-x: auto }} ul {{ columns: 2 }}
</style></head><body>
<h1>The thesis, figure by figure</h1>
<p>Every simulation of the thesis run again by <code>ExampleData/thesis.sh</code> on phantoms of the same kind: the
thesis's own polygons and surfaces are not published. {len(made)} of its figures are made anew here; where one is not,
the page says so. {seconds:.0f} seconds for all of it.</p>
<ul>{contents}</ul>
<h2>Reported numbers beside ours</h2><div class=scroll><table>
<tr><th>number</th><th>thesis</th><th>here</th><th>figure</th></tr>{rows}</table></div>
{''.join(self.body)}</body></html>"""
        (out / "thesis.html").write_text(text)


# ---- inputs -------------------------------------------------------------------------------------

def write_labels(path, labels, spacing):
    """labels[j, i] as a NIfTI image of one slice."""
    image = nibabel.Nifti1Image(labels.T[..., None].astype(numpy.uint8), numpy.diag([spacing, spacing, 1, 1]))
    image.header.set_xyzt_units("mm")
    nibabel.save(image, path)


def ellipse_and_circle(path):
    """The region of figure 3.2: between an ellipse and a circle."""
    spacing, size = 0.5, 152
    x = (numpy.arange(size) - size / 2) * spacing
    X, Y = numpy.meshgrid(x, x)
    labels = numpy.where((X / 34) ** 2 + (Y / 22) ** 2 < 1, 2, 0)
    labels[(X - 7) ** 2 + Y ** 2 < 11.3 ** 2] = 1
    write_labels(path, labels, spacing)


def write_curve(path, radius):
    """A closed curve, radius(t) mm."""
    t = numpy.linspace(0, 2 * math.pi, 400, endpoint=False)
    r = radius(t) * numpy.ones_like(t)
    numpy.savetxt(path, numpy.stack([r * numpy.cos(t), r * numpy.sin(t)], 1), delimiter=",", fmt="%.6f")


def icosphere(level):
    g = (1 + 5 ** 0.5) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
         (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    v = [tuple(numpy.array(p) / numpy.linalg.norm(p)) for p in v]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
         (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
         (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(level):
        middle, finer = {}, []
        def half(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                p = numpy.array(v[a]) + v[b]
                v.append(tuple(p / numpy.linalg.norm(p)))
                middle[key] = len(v) - 1
            return middle[key]
        for a, b, c in f:
            x, y, z = half(a, b), half(b, c), half(c, a)
            finer += [(a, x, z), (b, y, x), (c, z, y), (x, y, z)]
        f = finer
    return numpy.array(v), numpy.array(f)


def write_surface(path, radius, level=4):
    """A closed surface about the origin, radius(x, y, z) mm in each direction."""
    v, f = icosphere(level)
    write_off(path, v * radius(v[:, 0], v[:, 1], v[:, 2])[:, None], f)


def write_off(path, v, f):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(v)} {len(f)} 0\n")
        file.writelines("%.6f %.6f %.6f\n" % tuple(p) for p in v)
        file.writelines("3 %d %d %d\n" % tuple(t) for t in f)


def read_off(path):
    """Vertices (V, 3) and faces (F, 3) of a file of write_off()."""
    numbers = path.read_text().split()
    v, f = int(numbers[1]), int(numbers[2])
    return (numpy.array(numbers[4:4 + 3 * v], float).reshape(v, 3),
            numpy.array(numbers[4 + 3 * v:], int).reshape(f, 4)[:, 1:])


def data(path):
    return numpy.asarray(nibabel.load(path).dataobj, dtype=float)


# ---- chapters -----------------------------------------------------------------------------------

def chapter_3_tissue(work, page, heart):
    page.section("3.1 Correspondences in annular tissue")
    labels = work.path("ellipse.nii.gz")
    ellipse_and_circle(labels)
    work.run("ellipse", "thickness", labels, "--inner", 1, "--tissue", 2)
    page.figure(["3.1", "3.2"],
                "A region between an ellipse and a circle: the interpolant u, its tangent field, and correspondence "
                "trajectories from the inner (red) to the outer boundary (blue). ",
                *thesis_figures.annular_field(work.path("ellipse")), command=work.commands["ellipse"], wide=True)
    if heart:
        words = [heart, "--inner", 1, "--tissue", 2]
        whose = "the heart that was given"
    else:
        work.run("ventricle", "phantom", "ventricle", "--size", 64, "--spacing", 1.8)
        words = [work.path("ventricle") / "labels.nii.gz", "--inner", 1, "--tissue", 2]
        whose = "the phantom of a left ventricle, as no heart was given"
    measured = work.run("myocardium", "thickness", *words, "--per-slice", "--cells", 4)
    page.figure(["3.3"], f"A short-axis slice of {whose}: boundaries, tangent field, boundary correspondences of "
                         "selected points, and the generated grid. ",
                *thesis_figures.annular_field(work.path("myocardium"), work.path("myocardium") / "grid.vtu"),
                command=work.commands["myocardium"], wide=True)
    page.number("grid_cells_degenerate", "cells of the grid with a Jacobian that is not positive", "not reported",
                measured["grid_cells_degenerate"], f"{measured['grid_cells_degenerate']} kept out of "
                f"{measured['grid_cells'] + measured['grid_cells_degenerate']}", "3.3")


def appendix_a(work, page):
    page.section("Appendix A: the hybrid, and its dial")
    truth = work.path("spheroid")
    work.run("spheroid", "phantom", "spheroid", "--size", 64, "--spacing", 2)
    exact = {name: data(truth / f"{name}.nii.gz") for name in ("inner_point", "outer_point", "thickness")}
    levels = ["--inner-level", truth / "inner_level.nii.gz", "--outer-level", truth / "outer_level.nii.gz"]

    def measure(name, *words):
        summary = work.run(name, "thickness", *levels, "--sulci", "ignore", *words)
        folder = work.path(name)
        thickness = data(folder / "thickness.nii.gz")
        # Exact answers and ours are both there.
        tissue = (thickness > 0) & (exact["thickness"] > 0)
        points = 0
        for side in ("inner_point", "outer_point"):
            off = data(folder / f"{side}.nii.gz") - exact[side]
            points += 0.5 * numpy.linalg.norm(numpy.squeeze(off), axis=-1)[tissue].mean()
        result = {"points": points, "seconds": summary["seconds_correspondence"],
                  "thickness": abs(thickness - exact["thickness"])[tissue].mean(),
                  "traced": summary["traced_fraction"]}
        shutil.rmtree(folder)
        return result

    pure = {name: measure(name, "--method", name) for name in ("lagrangian", "eulerian")}
    dial = [0.2, 0.5, 1, 1.5, 2, 3, math.inf]
    ours, literal = {}, {}
    for value in dial:
        word = "inf" if math.isinf(value) else f"{value:g}"
        literal[value] = measure(f"appendix-{word}", "--method", "appendix-a", "--lambda", word)
        ours[value] = measure(f"hybrid-{word}", "--method", "hybrid", "--lambda", word)
    rows = [[n, "", f"{r['points']:.4f}", f"{r['thickness']:.4f}", f"{1000 * r['seconds']:.0f}",
             f"{100 * r['traced']:.0f} %"] for n, r in pure.items()]
    for name, found in (("appendix A", literal), ("ours", ours)):
        rows += [[name, "∞" if math.isinf(v) else f"{v:g}", f"{r['points']:.4f}", f"{r['thickness']:.4f}",
                  f"{1000 * r['seconds']:.0f}", f"{100 * r['traced']:.0f} %"] for v, r in found.items()]
    slower = [v for v in dial if literal[v]["seconds"] > pure["lagrangian"]["seconds"]]
    page.text("Confocal spheroids at 2 mm, whose correspondences are known exactly. Appendix A to the letter takes the "
              "Eulerian average where the upwind neighbours' boundary points are nearer than λ, else follows the "
              "trajectory to the first grid face that agrees. Its error depends on λ, from the Lagrangian's to that of "
              "the Eulerian sweep with better boundary values. Ours follows every trajectory to the first face and "
              "interpolates there to second order: its error is near the Lagrangian's for every λ, with no jump at "
              "infinity. "
              + (f"Here the claim that the hybrid saves time does not hold for λ up to {max(slower):g} mm: appendix A took "
                 "longer than following every trajectory." if slower else
                 "Appendix A took less time than following every trajectory at every λ."))
    chart = lambda key, label, factor: chart_of(
        [("appendix A", "#c0392b", [(v, factor * r[key]) for v, r in literal.items()]),
         ("ours", "#145ab4", [(v, factor * r[key]) for v, r in ours.items()]),
         ("Lagrangian", "#7a7f85", [(dial[0], factor * pure["lagrangian"][key]),
                                    (dial[-1], factor * pure["lagrangian"][key])]),
         ("Eulerian", "#b98a00", [(dial[0], factor * pure["eulerian"][key]),
                                  (dial[-1], factor * pure["eulerian"][key])])],
        "λ, mm (2 mm a voxel)", label)
    page.figure([], "<b>Error and time over λ.</b> Mean distance of the boundary points from the exact ones, and "
                    "wall time of the correspondences. ",
                chart("points", "error of boundary points, mm", 1), chart("seconds", "time, ms", 1000),
                command="explica thickness --inner-level ... --outer-level ... --method appendix-a --lambda L")
    page.table(["method", "λ, mm", "boundary points, mm", "thickness, mm", "ms", "followed"], rows)
    lagrangian = pure["lagrangian"]["points"]
    page.number("appendix_a_dial", "appendix A: error at λ = ∞ over that at 0.2 mm", "λ controls the accuracy",
                literal[math.inf]["points"] / literal[0.2]["points"], "{:.1f}", "3.3")
    page.number("hybrid_worst", "ours: largest error over λ, relative to the Lagrangian method", "not reported",
                max(r["points"] for r in ours.values()) / lagrangian, "{:.2f}", "3.3")


def chapter_3_shapes(work, page):
    page.section("3.2 Harmonic embedding")
    annulus = ["--center", "0,0,0", "--inner-radius", 21, "--outer-radius", 40, "--order", 8, "--cells", 56]
    look = ["--direction", "0.5,-0.75,0.45", "--width", 320, "--height", 320]
    targets = {"cube": lambda x, y, z: 30 * (1 - 0.3 * (x ** 4 + y ** 4 + z ** 4 - 0.6)),
               "pear": lambda x, y, z: 30 * (1 + 0.13 * z + 0.12 * (x * x - y * y))}
    for name, number in (("cube", "3.4"), ("pear", "3.5")):
        surface = work.path(f"{name}.off")
        write_surface(surface, targets[name])
        fit = work.run(name, "embed", surface, "--fit", *annulus, "--samples", 1000,
                       "--fit-start", 0.15 if name == "cube" else 0.85)
        frames = sorted((work.path(name) / "frames").glob("*.surf.gii"))
        views = [work.picture(f"{name}-{n}.png", frame, *look) for n, frame in enumerate(frames)]
        page.figure([number], f"Evolution from an initial estimate to the minimum of the set-symmetric difference, "
                              f"and the target (last); the fit ends {fit['distance_max']:.2f} mm away at most, where "
                              f"half a voxel is {fit['voxel'] / 2:.2f} mm. ",
                    *views, work.picture(f"{name}-target.png", surface, *look), command=work.commands[name])
        page.number(f"fit_{name}", f"largest distance of the fit from its target, in voxels (figure {number})",
                    "not reported", fit["distance_max"] / fit["voxel"], "{:.2f}", number)
    coefficients = [work.path(n) / "coefficients.json" for n in ("cube", "pear")]
    steps = [k / 8 for k in range(9)]
    series = [work.run(f"series{k}", "embed", *coefficients, "--combine", f"{1 - share},{share}", "--cells", 56)
              for k, share in enumerate(steps)]
    work.run("average", "embed", *coefficients, "--average", "--cells", 56)
    views = [work.picture(f"{n}.png", work.path(n) / "shape.surf.gii", *look) for n in ("cube", "average", "pear")]
    page.figure(["3.6"], "The average of the two: the mean of their coefficients (middle). ", *views,
                command=work.commands["average"])
    views = [work.picture(f"series{k}.png", work.path(f"series{k}") / "shape.surf.gii", *look) for k in range(9)]
    page.figure(["3.7"], "Convex combinations of the two, from the first to the second. ", *views,
                command=work.commands["series4"])
    page.number("series_margin", "least distance of boundary values from 1/2 over the series: above 0 every "
                "combination is one closed surface", "one surface", min(s["boundary_margin"] for s in series), "{:.3f}",
                "3.7")
    for a, b in ((18, 22), (15, 25)):
        for r in (a, b):
            write_curve(work.path(f"circle{r}.csv"), lambda t, r=r: r + 0 * t)
        work.run("circles", "embed", work.path(f"circle{a}.csv"), work.path(f"circle{b}.csv"), "--average",
                 "--center", "0,0,0", "--inner-radius", 12.5, "--outer-radius", 29)
        r = numpy.linalg.norm(numpy.loadtxt(work.path("circles") / "shape.csv", delimiter=",", skiprows=1), axis=1)
        page.number(f"circles_{a}_{b}", f"average of circles of {a} and {b} mm: farthest from the circle of their "
                                        "geometric mean, mm", "not reported", float(abs(r - math.sqrt(a * b)).max()),
                    f"{abs(r - math.sqrt(a * b)).max():.4f}", "3.6")


def polygon_of(work, name):
    """Vertices of a run's polygon, and its region's edges: those of a phantom come first."""
    polygon = numpy.loadtxt(work.path(name) / "polygon.csv", delimiter=",", skiprows=1)
    edges = json.loads((work.path(name) / "summary.json").read_text())["region_edges"]
    return polygon, list(range(edges))


def definitions_4(work, page, p34):
    """Figures 4.10 to 4.12: what is seen from a point, and the flux of a point."""
    polygon, edges = polygon_of(work, "p34")
    svg, stretches, share = thesis_figures.visible_parts(polygon, edges)
    page.figure(["4.10"], f"What a viewpoint P sees of the polygon of 34 edges: {stretches} stretches (blue), "
                          f"{100 * share:.0f} % of the region. P stands near here, far off in the simulations. ", svg)
    svg, values = thesis_figures.region_of_interest(polygon, edges)
    told = ", ".join(f"{name} {flux:+.2f} ({'seen' if seen else 'not seen'})"
                     for name, (flux, seen) in sorted(values.items()))
    page.figure(["4.11"], f"The region of interest from a to b, and the flux of points of it: {told}. Rays meet g at "
                          "nearly right angles and c at a slant; e would be lit if nothing stood in the way; d faces "
                          "away. ", svg)
    svg, flux = thesis_figures.flux_of_a_point()
    page.figure(["4.12"], "The flux of a point: the unit ray from P times the inward unit normal. ", svg)
    page.number("points_4.11", "flux of the seen point g less that of the seen point c", "greater",
                values["g"][0] - values["c"][0], f"{values['g'][0]:.2f} and {values['c'][0]:.2f}", "4.11")
    page.number("hidden_4.11", "flux of the hidden point e, which faces P", "positive", values["e"][0], "{:.2f}",
                "4.11")
    page.number("away_4.11", "flux of the hidden point d, which faces away", "negative", values["d"][0], "{:.2f}",
                "4.11")


def edges_and_rays(work, page):
    """Figure 4.16: an edge receives most where rays meet it at right angles; closed form beside quadrature."""
    eye, length = numpy.array([0.0, 60.0]), 40
    pictures, totals, apart = [], [], 0
    for name, angle in (("upright", 0.0), ("slanted", math.radians(55))):
        svg, total, (a, b) = thesis_figures.edge_and_rays(length, angle, eye)
        pictures.append(svg)
        totals.append(total)
        below = 0.5 * (a + b) - [0, 200]
        numpy.savetxt(work.path(f"{name}.csv"), numpy.stack([a, b, below]), delimiter=",", fmt="%.12g")
        ours = work.run(f"edge-{name}", "polygon", work.path(f"{name}.csv"), "--region", "0:1", "--viewpoint",
                        f"{eye[0]:g},{eye[1]:g}", "--max-iterations", 1)
        apart = max(apart, abs(ours["visibility_initial"] * length - total))
    page.figure(["4.16"], f"Two edges of the same length: the flux is {totals[0]:.2f} where rays meet it at right angles "
                          f"(a) and {totals[1]:.2f} where they come at a slant (b). ", *pictures,
                command=work.commands["edge-slanted"])
    page.number("edge_flux", "flux of an edge: closed form (4.11) less quadrature, px", "closed form", apart, "{:.1e}",
                "4.16")
    page.number("edge_gain", "flux of the edge at right angles over that at a slant", "greater", totals[0] / totals[1],
                "{:.2f}", "4.16")


def chapter_4(work, page):
    page.section("4.1 Global measures")
    p19 = work.run("p19", "polygon", "--phantom", "polygon19")
    polygon, edges = polygon_of(work, "p19")
    for measure, number, most, caption in (
            ("arc", "4.8", 600, "The measure (4.6), how much of a viewing circle is hidden, and its flow: curve "
             "shortening, which smooths and does not unfold. "),
            ("occlusion", "4.9", 2000, "The measure (4.7), how much the polygon hides itself, and its flow: it ends "
             "nearly convex, with the length of the folds lost. ")):
        states = thesis_flows.polygon_flow(polygon, measure, most)
        page.figure([number], caption, *thesis_figures.flow_states(states, edges), wide=True)
        kept = thesis_figures.length_of(states[-1], edges) / thesis_figures.length_of(polygon, edges)
        page.number(f"length_kept_{measure}", f"length of the region that the flow of figure {number} keeps",
                    "does not unfold", kept, f"{100 * kept:.0f} %", number)

    surface = work.path("lobes.off")
    write_surface(surface, lambda x, y, z: 30 * (1 + 0.35 * (1 - z * z) * numpy.sin(5 * numpy.arctan2(y, x))), level=3)
    pictures, kept = [work.picture("lobes.png", surface, "--direction", "0.3,-0.6,0.75", "--width", 260, "--height", 260)], {}
    vertices, faces = read_off(surface)
    area = thesis_flows.Faces(vertices, faces).area.sum()
    for name in ("area", "occlusion"):
        ended = thesis_flows.surface_flow(vertices, faces, name, 120)
        kept[name] = thesis_flows.Faces(ended, faces).area.sum() / area
        write_off(work.path(f"{name}.off"), ended, faces)
        pictures.append(work.picture(f"{name}.png", work.path(f"{name}.off"), "--direction", "0.3,-0.6,0.75",
                                     "--width", 260, "--height", 260))
    ours = work.run("lobes", "inflate", surface)
    pictures.append(work.picture("lobes-ours.png", work.path("lobes") / "inflated.surf.gii", "--direction", "0.3,-0.6,0.75",
                                 "--width", 260, "--height", 260))
    page.figure([], f"<b>Both measures of a closed surface.</b> A lobed surface; after the flow of (4.6), which keeps "
                    f"{100 * kept['area']:.0f} % of its area; after that of (4.7), which keeps "
                    f"{100 * kept['occlusion']:.0f} %; and inflated by our steps to global visibility "
                    f"{ours['visibility_final']:.3f} with areas kept to {100 * ours['area_error_mean']:.1f} %. ", *pictures,
                command=work.commands["lobes"])
    inflated = nibabel.load(work.path("lobes") / "inflated.surf.gii").agg_data("pointset").astype(float)
    hides = [thesis_flows.occlusion_of_surface(v, faces) for v in (vertices, inflated)]
    page.number("area_kept_4.7", "area that the flow of (4.7) keeps of a lobed closed surface", "does not unfold",
                kept["occlusion"], f"{100 * kept['occlusion']:.0f} %", "4.9")
    page.number("occlusion_inflated", "what hides itself (4.7) after our inflation, share of the start", "not reported",
                hides[1] / hides[0], "{:.2g}", "4.9")

    page.section("4.2 Unfolding of polygons")
    p34 = work.run("p34", "polygon", "--phantom", "polygon34")
    t19 = work.run("thesis19", "polygon", "--phantom", "polygon19", "--method", "thesis", "--no-collision")
    t34 = work.run("thesis34", "polygon", "--phantom", "polygon34", "--method", "thesis", "--no-collision")
    definitions_4(work, page, p34)
    facing = {name: work.run(f"{name}-seen", "polygon", "--phantom", f"polygon{name[1:]}", "--region", "seen",
                             "--max-iterations", 1)["region_edges"] for name in ("p19", "p34")}
    page.number("region_seen_19", "region between the extremities of the view, edges (19 are unfolded below)",
                "automatic, out of scope", facing["p19"], f"{facing['p19']} of {len(polygon)}", "4.11")
    page.number("region_seen_34", "the same of the polygon whose 34 edges are unfolded below",
                "automatic, out of scope", facing["p34"], "{}", "4.11")
    page.figure(["4.13", "4.15", "4.17"],
                f"The region of 19 edges from its viewpoint, by our implicit steps: the colour of an edge is its flux. ",
                work.path("p19") / "evolution.svg", command=work.commands["p19"], wide=True)
    half = work.run("seen40", "polygon", "--phantom", "polygon19", "--method", "thesis", "--no-collision",
                    "--target-visibility", 0.4)
    opened = numpy.loadtxt(work.path("seen40") / "unfolded.csv", delimiter=",", skiprows=1)
    page.figure(["4.14"], f"A region on its way whose average visibility is {half['visibility_final']:.2f}: what is truly "
                          f"seen of it (blue), {100 * half['seen_final']:.0f} % of its length, has "
                          f"{half['real_visibility_final']:.2f} by its cosine. So the flux estimates the “real” average "
                          "visibility: ",
                thesis_figures.seen_region(opened, list(range(half["region_edges"])), numpy.array(half["viewpoint"])),
                command=work.commands["seen40"])
    page.table(["region", "flux", "seen", "seen times cosine"],
               [[f"{n}, {when}", f"{r['visibility_' + when]:.3f}", f"{r['seen_' + when]:.3f}",
                 f"{r['real_visibility_' + when]:.3f}"]
                for n, r in (("19 edges", p19), ("34 edges", p34)) for when in ("initial", "final")])
    page.number("flux_40", "region of figure 4.14: average visibility", "0.4", half["visibility_final"], "{:.3f}",
                "4.14")
    page.number("real_40", "the same: seen times cosine less the flux", "a good estimate",
                half["real_visibility_final"] - half["visibility_final"], "{:+.3f}", "4.14")
    page.number("real_19", "19 edges: real visibility less its estimate by the flux, at the start", "a good estimate",
                p19["real_visibility_initial"] - p19["visibility_initial"], "{:+.3f}", "4.14")
    edges_and_rays(work, page)
    page.figure(["4.18"],
                "The region of 34 edges by the thesis's explicit flow (4.20), the knot energy as the only guard, "
                "collision detection off: no edge crosses another on the way. ",
                work.path("thesis34") / "evolution.svg", command=work.commands["thesis34"], wide=True)
    collapse = work.run("collapse", "polygon", "--phantom", "polygon34", "--method", "thesis", "--no-length",
                        "--no-collision")
    page.figure(["4.19"], "The same without length constraints: the region shrinks itself. ",
                work.path("collapse") / "evolution.svg", command=work.commands["collapse"], wide=True)
    crossing = work.run("crossing", "polygon", "--phantom", "polygon34", "--method", "thesis", "--no-topology",
                        "--explicit-step", 0.1, "--stages", 9)
    page.figure(["4.20"], f"Without topology preservation edges cross after {crossing['first_crossing']} iterations "
                          "(rings), at steps of a tenth of an edge. ",
                work.path("crossing") / "evolution.svg", command=work.commands["crossing"], wide=True)
    rows = []
    for name, edges, thesis, method, run in (
            ("4.17", 19, "0.21, 0.39, 416, 418.79, 1.50", "ours", p19), ("4.17", 19, "", "explicit", t19),
            ("4.18", 34, "0.17, 0.69, 723.70, 727.60, 40", "ours", p34), ("4.18", 34, "", "explicit", t34)):
        rows.append([f"{edges} edges", method, f"{run['visibility_initial']:.3f} to {run['visibility_final']:.3f}",
                     f"{run['flux_variance_initial']:.3f} to {run['flux_variance_final']:.1e}",
                     f"{run['length_initial']:.2f} to {run['length_final']:.2f}", run["iterations"],
                     f"{1000 * run['seconds']:.0f} ms, {1000 * run['seconds_topology']:.0f} ms for the topology",
                     run["self_intersections_final"]])
    page.table(["region", "method", "visibility", "flux variance", "length, px", "iterations", "time", "crossings"], rows)
    for key, edges, run, explicit, thesis in (
            ("19", 19, p19, t19, ("0.21", "0.39", "416 to 418.79 px", "1.50 s, 0.70 s for the topology")),
            ("34", 34, p34, t34, ("0.17", "0.69", "723.70 to 727.60 px", "40 s, 36 s for the topology"))):
        where = "4.17" if key == "19" else "4.18"
        page.number(f"visibility_initial_{key}", f"{edges} edges: initial average visibility", thesis[0],
                    run["visibility_initial"], "{:.3f}", where)
        page.number(f"variance_initial_{key}", f"{edges} edges: initial variance of the flux", thesis[1],
                    run["flux_variance_initial"], "{:.3f}", where)
        page.number(f"visibility_final_{key}", f"{edges} edges: final average visibility", "almost 1",
                    run["visibility_final"], "{:.4f}", where)
        page.number(f"variance_final_{key}", f"{edges} edges: final variance of the flux",
                    "0" if key == "19" else "almost 0", run["flux_variance_final"], "{:.1e}", where)
        page.number(f"length_{key}", f"{edges} edges: length kept by ours (relative change)", thesis[2],
                    abs(run["length_final"] / run["length_initial"] - 1),
                    f"{run['length_initial']:.2f} to {run['length_final']:.2f} px", where)
        page.number(f"length_explicit_{key}", f"{edges} edges: length kept by the thesis's flow", thesis[2],
                    abs(explicit["length_final"] / explicit["length_initial"] - 1),
                    f"{explicit['length_initial']:.2f} to {explicit['length_final']:.2f} px", where)
        page.number(f"knot_alone_{key}", f"{edges} edges: crossings with the knot energy as the only guard", "none",
                    explicit["self_intersections_final"] + max(0, explicit["first_crossing"]),
                    f"{explicit['self_intersections_final']}", where)
        page.number(f"seconds_{key}", f"{edges} edges: time, ours (thesis: a 2.52 GHz Pentium IV)", thesis[3],
                    run["seconds"], f"{run['seconds']:.3f} s, {run['seconds_topology']:.3f} s for the topology", where)
    page.number("length_collapse", "34 edges without length constraints: length at the end",
                "723.70 to 205.41 px", collapse["length_final"],
                f"{collapse['length_initial']:.2f} to {collapse['length_final']:.2f} px", "4.19")
    page.number("edges_collapse", "the same: vertices of the region", "34 to 13", 34 - collapse["vertices_merged"],
                "34 to {}", "4.19")
    page.number("visibility_collapse", "the same: average visibility", "0.17 to almost 1",
                collapse["visibility_final"],
                f"{collapse['visibility_initial']:.2f} to {collapse['visibility_final']:.3f}", "4.19")
    coarse = work.run("crossing-coarse", "polygon", "--phantom", "polygon34", "--method", "thesis", "--no-topology",
                      "--explicit-step", 1)
    page.number("first_crossing", "34 edges without topology preservation: iterations to the first crossing, at steps "
                "of a tenth of an edge", "“after a few iterations”", crossing["first_crossing"], "{}", "4.20")
    page.number("first_crossing_coarse", "the same at steps of an edge", "drawn after 10 and 100",
                coarse["first_crossing"], "{}", "4.20")


def frames_of(folder):
    return sorted((folder / "frames").glob("frame-*.surf.gii"))


def strip(work, name, frames, direction, region, size=270):
    """Pictures of frames, in a row."""
    pictures = []
    for k, frame in enumerate(frames):
        words = [frame, "--direction", direction, "--width", size, "--height", size]
        if region:
            words += ["--labels", region]
        pictures.append(work.picture(f"{name}-{k}.png", *words))
    return pictures


def clear_visibility(work, before, name):
    """Visibility of the last frame before one with crossing faces, and whether all were without."""
    summary = json.loads((work.path(name) / "summary.json").read_text())
    if summary["self_intersections_frames_max"] == 0:
        return summary["frame_visibilities"][-1], True
    work.run(name + "-compared", "compare", before, *frames_of(work.path(name)), "--pairs", 100, "--sources", 4)
    table = (work.path(name + "-compared") / "comparison.tsv").read_text().splitlines()
    columns = table[0].split("\t")
    crossings = [int(float(line.split("\t")[columns.index("crossings")])) for line in table[1:]]
    reached, clear = summary["visibility_initial"], True
    for count, visibility in zip(crossings, summary["frame_visibilities"]):
        if count > 0:
            clear = False
            break
        reached = visibility
    return reached, clear


def steps_judged(work, name):
    """How many steps of a run have one of its frames between their start and their end, by visibility."""
    lines = (work.path(name) / "evolution.tsv").read_text().splitlines()
    column = lines[0].split("\t").index("visibility")
    steps = [float(line.split("\t")[column]) for line in lines[1:]]
    frames = json.loads((work.path(name) / "summary.json").read_text())["frame_visibilities"]
    return sum(any(a <= v <= b for v in frames) for a, b in zip(steps, steps[1:]))


def definitions_5(work, page):
    """Figures 5.21 to 5.23: region and viewpoint, a face's corners, the merging tree."""
    page.section("5.1 and 5.4 Region, face and tree")
    surface, region = work.path("folds") / "folds.surf.gii", work.path("folds") / "region.label.gii"
    width, height = 620, 430
    picture = work.picture("region-of-interest.png", surface, "--labels", region, "--direction", "0.45,-1,0.75",
                           "--width", width, "--height", height)
    page.figure(["5.21"], "The region of interest S<sub>v</sub> (coloured) of a surface S, and the external viewpoint P. ",
                thesis_figures.over_picture(picture, width, height, (width / 2, 26),
                                            [(x * width, 70 + y * height) for x, y in
                                             ((0.36, 0.53), (0.49, 0.62), (0.55, 0.19), (0.65, 0.3), (0.6, 0.5))],
                                            "the region of the folded sheet of figure 5.24"))
    svg, before = thesis_figures.face_with_normal()
    page.figure(["5.22"], "A face S<sub>i</sub> with its corners counter-clockwise seen from outside, and its inward unit "
                          f"normal (69): (v<sub>a</sub> − P) · N = {before:.1f} is positive where the face looks at P. ", svg)
    tree = thesis_figures.tree_of_the_figure()
    drawings, starts = [thesis_figures.draw_tree(tree, "(a) the tree of nine faces")[0]], []
    for letter, face, near in (("b", 1, [2]), ("c", 4, [3, 5]), ("d", 6, [5, 7])):
        drawn, begins = thesis_figures.draw_tree(tree, f"({letter}) forces on face {face}", face, near)
        drawings.append(drawn)
        starts.append(begins)
    page.figure(["5.23"], "The merging algorithm's tree of nine faces, and what is left of it for faces 1, 4 and 6 (grey): "
                          "neighbours (orange) exactly, then recursion from the green nodes. The same tree and the "
                          "same nodes are pinned in the software's test “MergingTree”. ", *drawings)
    page.number("tree_nodes", "nodes of the tree of nine faces", "16", max(tree.centre), "{}", "5.23")
    page.number("tree_three", "children of node 11", "3 (faces 3 to 5)", len(tree.children[11]),
                ", ".join(map(str, tree.children[11])), "5.23")
    page.number("tree_start", "face 1: node at which the recursion begins", "15", starts[0][0],
                ", ".join(map(str, starts[0])), "5.23")


def chapter_5_folds(work, page):
    page.section("5.6 A synthetic surface")
    work.run("folds", "phantom", "folds", "--edge", 1)
    surface, region = work.path("folds") / "folds.surf.gii", work.path("folds") / "region.label.gii"
    ours = work.run("folds-open", "unfold", surface, "--label", region, "--direction", "0,0,1", "--frames", 5)
    pictures = strip(work, "folds-open", frames_of(work.path("folds-open")), "0.45,-1,0.75", region, size=215)
    page.figure(["5.24"],
                f"A sheet whose folds hide each other, seen from above (the pictures look from the side): average "
                f"visibility {ours['visibility_initial']:.2f}, seen {ours['seen_initial']:.2f}; by our implicit steps "
                f"{ours['visibility_final']:.4f} and {ours['seen_final']:.3f}, areas kept to "
                f"{100 * ours['area_error_mean']:.2f} %, no crossing. ", *pictures,
                command=work.commands["folds-open"])
    page.number("folds_initial", "synthetic surface: initial visibility", "0.2", ours["visibility_initial"], "{:.3f}",
                "5.24")
    page.number("folds_final", "synthetic surface: final visibility", "very close to 1", ours["visibility_final"],
                "{:.4f}", "5.24")
    page.number("folds_crossings", "synthetic surface: crossings at the end", "topology preserved",
                ours["self_intersections_final"], "{}", "5.24")

    page.section("5.3 and 5.4 The thesis's own flow in space")
    work.run("coarse", "phantom", "folds", "--edge", 2.5, "--length", 60, "--waves", 3)
    surface, region = work.path("coarse") / "folds.surf.gii", work.path("coarse") / "region.label.gii"
    aim = [surface, "--label", region, "--direction", "0,0,1", "--method", "thesis"]
    literal = work.run("literal", "unfold", *aim, "--surround", "none", "--knot", "thesis-tree", "--knot-weight", 0.03,
                       "--max-iterations", 200, "--frames", 12)
    shown = [frames_of(work.path("literal"))[k] for k in (0, 3, 6, 9, 11)]
    reached, clear = clear_visibility(work, surface, "literal")
    page.figure([], f"<b>The flow as the thesis has it</b>: (5.46) with (5.43) to (5.45), the merging tree and projected "
                    f"areas, no collision detection, knot weight 0.03, the region cut out of its surroundings. "
                    f"Visibility {literal['visibility_initial']:.2f} to {literal['visibility_final']:.3f}, "
                    f"{'no faces cross in any of twelve states on the way' if clear else f'faces cross from {reached:.2f} on'}; areas drift by "
                    f"{100 * literal['area_error_mean']:.0f} % in the mean, since their projection is of first order. ",
                *strip(work, "literal", shown, "0.45,-1,0.75", None, size=215),
                command=work.commands["literal"])
    page.number("literal_final", "the thesis's flow in space, region alone: final visibility", "very close to 1",
                literal["visibility_final"], "{:.3f}", "5.24")
    page.number("literal_clear", "the same: visibility reached before any faces cross", "topology preserved", reached,
                "{:.3f}", "5.24")
    weights = [0.01, 0.03, 0.1]
    found = {}
    for surround, weight in itertools.product(("none", "fixed"), weights):
        name = f"flow-{surround}-{weight:g}"
        work.run(name, "unfold", *aim, "--surround", surround, "--knot", "tree", "--knot-weight", weight,
                 "--max-iterations", 200, "--frames", 12)
        found.setdefault(surround, []).append((weight, clear_visibility(work, surface, name)[0]))
    best = {surround: max(v for _, v in points) for surround, points in found.items()}
    page.figure([], "<b>The limit of the knot energy alone.</b> Visibility that the flow has reached when faces cross "
                    "first in one of twelve states, or when its 200 iterations end, over the weight of "
                    "the knot energy, by our tree. The energy of two triangles stays "
                    "finite where edges meet edges, so it stops a crossing only if it is heavy beside the flux; where "
                    "surroundings hold the region, a weight that heavy holds it shut. ",
                chart_of([(place, colour, points) for (place, points), colour in zip(found.items(), ("#145ab4", "#c0392b"))],
                          "weight of the knot energy", "visibility without a crossing", y_log=False),
                command=work.commands["flow-none-0.01"])
    page.number("flow_limit_none", "the thesis's flow in space, region alone: best visibility without a crossing over "
                "weights", "very close to 1", best["none"], "{:.2f}", "5.24")
    page.number("flow_limit_fixed", "the same in surroundings that stay", "very close to 1", best["fixed"], "{:.2f}",
                "5.24")
    # Time of one iteration.
    times = {}
    for knot in ("all-pairs", "thesis-tree", "tree"):
        run = work.run(f"time-{knot}", "unfold", *aim, "--surround", "fixed", "--knot", knot, "--knot-weight", 0.01, "--max-iterations", 2)
        times[knot] = run["seconds_repulsion"] / max(1, run["iterations"])
    faces = json.loads((work.path("time-tree") / "summary.json").read_text())["region_faces"]
    page.text(f"Time of the topology forces in one iteration, {faces} faces that move: all pairs "
              f"{times['all-pairs']:.2f} s, the thesis's merging tree {times['thesis-tree']:.2f} s, ours "
              f"{1000 * times['tree']:.1f} ms. The thesis reports 20 minutes and 5 seconds for about 1,500 faces of a "
              "whole cortex on a 2.53 GHz computer.")
    for key, name, thesis in (("all-pairs", "all pairs", "about 20 min"), ("thesis-tree", "merging tree", "5 s"),
                              ("tree", "our tree", "not applicable")):
        page.number(f"seconds_{key}",
                    f"seconds an iteration for the topology forces, {name} (thesis: about 1,500 faces of "
                    f"a cortex, 2.53 GHz; here: {faces} faces)", thesis, times[key], "{:.3g} s", "5.24")
    page.number("tree_gain", "time of all pairs over the merging tree", "20 min to 5 s: 240 times",
                times["all-pairs"] / times["thesis-tree"], "{:.1f}", "5.24")
    page.number("our_gain", "time of the thesis's tree over ours", "not applicable",
                times["thesis-tree"] / times["tree"], "{:.0f}", "5.24")
    definitions_5(work, page)


def chapter_5_cortex(work, page, fsaverage):
    page.section("5.6 Regions of a cortex")
    if fsaverage:
        surface = Path(fsaverage) / "pial_left.gii.gz"
        whose = "fsaverage5's left pial surface"
        regions = {"5.25": ((-1, 0.2, 0.2), 25), "5.26": ((-0.2, -1, 0.3), 25), "5.27": ((-0.2, 0.1, 1), 25)}
    else:
        work.run("cortex", "phantom", "cortex", "--size", 40, "--depth", 0.3, "--waves", 4)
        work.run("cortex-surface", "surface", work.path("cortex") / "labels.nii.gz", "--white-label", 3, "--grey-label", 2,
                 "--faces", 5000)
        surface = work.path("cortex-surface") / "mid.surf.gii"
        whose = "the phantom of a cortex, as no real one was given"
        regions = {"5.25": ((0, 0, 1), 9), "5.26": ((1, 0.2, 0.2), 9), "5.27": ((0, -1, 0.6), 9)}
    rows, positions = [], nibabel.load(surface).darrays[0].data
    for number, (direction, radius) in regions.items():
        name = "region-" + number
        farthest = int((positions @ numpy.array(direction)).argmax())
        direction = ",".join(f"{x:g}" for x in direction)
        aim = [surface, "--vertex", farthest, "--radius", radius, "--direction", direction]
        ours = work.run(name, "unfold", *aim, "--frames", 4)
        literal = work.run(name + "-thesis", "unfold", *aim, "--surround", "none", "--method", "thesis", "--knot",
                           "thesis-tree", "--knot-weight", 0.2, "--max-iterations", 150, "--frames", 400)
        crossings, judged = literal["self_intersections_frames_max"], steps_judged(work, name + "-thesis")
        region = work.path(name) / "region.label.gii"
        pictures = strip(work, name, frames_of(work.path(name)), direction, region)
        page.figure([number], f"A region of {whose}: visibility {ours['visibility_initial']:.2f} to "
                              f"{ours['visibility_final']:.3f}, seen {ours['seen_initial']:.2f} to "
                              f"{ours['seen_final']:.3f}. ", *pictures, command=work.commands[name])
        page.figure([], f"The same region by the thesis's own flow and merging tree, {literal['iterations']} iterations as "
                        f"in the thesis, cut out of its surroundings: visibility "
                        f"{literal['visibility_final']:.3f}, seen {literal['seen_final']:.3f}, "
                        f"{'up to ' + str(crossings) if crossings else 'no'} crossing pairs at 400 states on the way, "
                        f"{judged} of its {literal['iterations']} steps among them; areas are kept to "
                        f"{100 * literal['area_error_mean']:.1f} %, edges change by {100 * literal['edge_strain_mean']:.0f} % "
                        f"(ours {100 * ours['edge_strain_mean']:.1f} %), as nothing keeps lengths. ",
                    *strip(work, name + "-thesis", frames_of(work.path(name + "-thesis"))[::133], direction, None),
                    command=work.commands[name + "-thesis"])
        page.number(f"thesis_region_{number}", f"figure {number} by the thesis's flow: final visibility",
                    "not reported", literal["visibility_final"], "{:.3f}", number)
        page.number(f"thesis_region_crossings_{number}",
                    f"figure {number} by the thesis's flow: most crossing pairs in a " "state on the way",
                    "topology preserved", crossings, "{}", number)
        page.number(f"thesis_steps_{number}", f"figure {number} by the thesis's flow: steps within which a state was judged",
                    "150 iterations", judged, f"{judged} of {literal['iterations']}", number)
        for method, run in (("ours", ours), ("thesis's flow, region alone", literal)):
            rows.append([number, run["region_faces"], method,
                         f"{run['visibility_initial']:.3f} to {run['visibility_final']:.3f}",
                         f"{run['real_visibility_initial']:.3f} to {run['real_visibility_final']:.3f}",
                         f"{run['flux_variance_initial']:.3f} to {run['flux_variance_final']:.3f}",
                         f"{100 * run['area_error_mean']:.2f} %", run["self_intersections_new"], run["iterations"],
                         f"{run['seconds_per_iteration']:.3f}"])
        page.number(f"region_{number}", f"region of a cortex (figure {number}): final visibility", "not reported",
                    ours["visibility_final"], "{:.3f}", number)
        page.number(f"region_crossings_{number}", f"figure {number}: crossing pairs that are new", "topology preserved",
                    ours["self_intersections_new"], "{}", number)
    page.table(["figure", "faces", "method", "flux", "seen times cosine", "flux variance", "area error", "crossings",
                "iterations", "s an iteration"], rows)
    return surface, work.path("region-5.25")


def round_off(surface, target):
    """A closed surface projected from its middle to the sphere of its area."""
    points, faces = (array.data for array in nibabel.load(surface).darrays[:2])
    corners = points[faces].astype(float)
    area = 0.5 * numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    away = points - points.mean(0)
    away *= math.sqrt(area / (4 * math.pi)) / numpy.linalg.norm(away, axis=1)[:, None]
    write_off(target, away, faces)


# Columns of `comparison.tsv` that the page shows: their names for people, and the unit's factor and format.
COMPARED = {"area_error_mean": ("area error, mean", 100, "{:.1f} %"),
            "area_error_max": ("largest", 100, "{:.1f} %"),
            "edge_strain_mean": ("edge strain, mean", 100, "{:.1f} %"),
            "angle_error_mean_deg": ("angle error, mean", 1, "{:.1f}°"),
            "geodesic_error_local": ("distances, local", 100, "{:.1f} %"),
            "geodesic_error_all": ("distances, all", 100, "{:.1f} %"),
            "turned_over": ("faces turned over", 1, "{:.0f}"),
            "crossings": ("crossing pairs", 1, "{:.0f}"),
            "seen": ("seen", 1, "{:.3f}")}


def compared(text, factor, shown):
    """A value of `comparison.tsv` for people; one that was not measured stays empty."""
    try:
        value = float(text)
    except ValueError:
        return ""
    return shown.format(factor * value) if math.isfinite(value) else ""


def comparison(work, page, fsaverage, surface, unfolded):
    page.section("Beside flat, inflated and spherical maps")
    maps = {"unfolded": unfolded / "unfolded.surf.gii"}
    if fsaverage:
        for name in ("infl", "sphere", "flat"):
            maps[name] = Path(fsaverage) / f"{name}_left.gii.gz"
    else:
        work.run("inflated", "inflate", surface, "--target-seen", 0.998)
        maps["inflated"] = work.path("inflated") / "inflated.surf.gii"
        maps["spherical"] = work.path("spherical.off")
        round_off(maps["inflated"], maps["spherical"])
        page.text("No fsaverage was given (<code>--fsaverage DIR</code>): the maps are the phantom's own, inflated by "
                  "<code>explica inflate</code>, and that projected to a sphere from its middle.")
    work.run("beside", "compare", surface, *maps.values(), "--label", unfolded / "region.label.gii", "--pairs", 4000)
    lines = (work.path("beside") / "comparison.tsv").read_text().splitlines()
    head = lines[0].split("\t")
    rows = [line.split("\t") for line in lines[1:]]
    beside = {name: dict(zip(head, row)) for name, row in zip(maps, rows[-len(maps):])}
    page.table(["map of the region"] + [name for name, _, _ in COMPARED.values()],
               [[name] + [compared(row.get(key, ""), *shown) for key, (_, *shown) in COMPARED.items()]
                for name, row in beside.items()])
    for name, row in beside.items():
        page.number(f"area_error_{name}", f"the region of figure 5.25, {name}: mean area error", "little distortion",
                    float(row["area_error_mean"]), f"{100 * float(row['area_error_mean']):.1f} %", "5.25")
        page.number(f"strain_{name}", f"the same, {name}: mean strain of edges", "little distortion",
                    float(row["edge_strain_mean"]), f"{100 * float(row['edge_strain_mean']):.1f} %", "5.25")


def errata(page):
    page.section("Errata of the thesis, each pinned by a test")
    page.table(["equation", "printed", "right", "test"], [
        ["(53)", "γ/|C|²", "γ/|C|", "<code>EdgeFlux.GradientShowsTheErratumOfEquation53</code>"],
        ["(4.19)", "weight 2 of the first sum", "weight 1", "<code>PolygonKnotEnergy.DoesNotChangeWhenAnEdgeIsSplit</code>"],
        ["(5.25)", "drops the factor 2 of (60)", "with the factor", "<code>SmoothFlow.NeedsTheFactorTwoThatTheThesisDrops</code>"],
        ["(5.44)", "last b, c are those of face i", "those of face j",
         "<code>PairIntegral.DerivativeOfSharedCornersNeedsTheOtherFacesOwnCorners</code>"],
        ["(5.45), (84)", "distance of sums of vertices", "of centroids",
         "<code>ThesisTree.DividesByTheCentroidDistanceNotByThatOfSums</code>"],
        ["(5.46)", "+ μ<sub>R</sub>", "− μ<sub>R</sub>: descent on a repulsive energy",
         "<code>AllPairs.DescentOnTheEnergyNeedsTheMinusSign</code>"]])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--explica", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--fsaverage", type=Path)
    parser.add_argument("--heart", type=Path)
    given = parser.parse_args()
    out = given.out.resolve()
    (out / "runs").mkdir(parents=True, exist_ok=True)
    theirs = [given.fsaverage and given.fsaverage.resolve(), given.heart and given.heart.resolve().parent]
    work, page, begin = Work(given.explica.resolve(), out, filter(None, theirs)), Page(), time.monotonic()

    def note(words):
        print(f"{time.monotonic() - begin:6.1f} s  {words}", file=sys.stderr, flush=True)

    chapter_3_tissue(work, page, given.heart and given.heart.resolve())
    note("3.1 correspondences")
    appendix_a(work, page)
    note("appendix A")
    chapter_3_shapes(work, page)
    note("3.2 shapes")
    chapter_4(work, page)
    note("4 polygons")
    chapter_5_folds(work, page)
    note("5 the folded sheet")
    surface, unfolded = chapter_5_cortex(work, page, given.fsaverage and given.fsaverage.resolve())
    note("5 the cortex")
    comparison(work, page, given.fsaverage and given.fsaverage.resolve(), surface, unfolded)
    errata(page)
    page.write(out, time.monotonic() - begin)
    note(f"look at {out / 'thesis.html'}")


if __name__ == "__main__":
    main()
