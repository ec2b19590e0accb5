# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Runs the thesis's simulations and writes them as one page; see thesis.sh.  Captions and what the thesis reports
are in thesis_captions.tsv and thesis_numbers.tsv."""

import argparse
import csv
import html
import itertools
import json
import math
import subprocess
import sys
import time
from pathlib import Path

import nibabel
import numpy
import scipy.spatial
from numpy.linalg import norm

import thesis_figures
import thesis_flows
from thesis_figures import BLUE, GREY, RED

PAGE = """<!doctype html><html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>The thesis, figure by figure</title><style>
body {{ font: 16px/1.5 sans-serif; color: #1a1d21; max-width: 1180px; margin: 2em auto; padding: 0 1em }}
figure div {{ display: flex; flex-wrap: wrap; gap: 10px }} figure img {{ max-width: 100%; height: auto }}
figcaption code {{ display: block; font-size: 13px; overflow-wrap: anywhere; background: #f1f3f5 }}
table {{ border-collapse: collapse; font-size: 15px }} td, th {{ border: 1px solid #d5d9dd; padding: 3px 9px }}
.scroll {{ overflow-x: auto }}
</style></head><body><h1>The thesis, figure by figure</h1>
<p>Every simulation of the thesis run again by <code>ExampleData/thesis.sh</code> on phantoms of the same kind: the
thesis's own polygons and surfaces are not published. {count} of its figures are made anew here, in {seconds:.0f}
seconds.</p><h2>Reported numbers beside ours</h2>{numbers}{body}</body></html>"""
ERRATA = [
    ["(53)", "γ/|C|²", "γ/|C|", "EdgeFlux.GradientShowsTheErratumOfEquation53"],
    ["(4.19)", "weight 2 of the first sum", "weight 1", "PolygonKnotEnergy.DoesNotChangeWhenAnEdgeIsSplit"],
    ["(5.25)", "drops the factor 2 of (60)", "with the factor", "SmoothFlow.NeedsTheFactorTwoThatTheThesisDrops"],
    ["(5.44)", "last b, c are those of face i", "those of face j",
     "PairIntegral.DerivativeOfSharedCornersNeedsTheOtherFacesOwnCorners"],
    ["(5.45), (84)", "distance of sums of vertices", "of centroids",
     "ThesisTree.DividesByTheCentroidDistanceNotByThatOfSums"],
    ["(5.46)", "+ μ<sub>R</sub>", "− μ<sub>R</sub>: descent on a repulsive energy",
     "AllPairs.DescentOnTheEnergyNeedsTheMinusSign"]]


class Run(dict):
    """A run's summary, with the folder of its results and its command."""

    def __init__(self, folder, command):
        super().__init__(json.loads((folder / "summary.json").read_text()))
        self.folder, self.command = folder, command

    def __truediv__(self, name):
        return self.folder / name

    def frames(self):
        return sorted((self / "frames").glob("*.surf.gii"))


class Work:
    """Runs explica into folders of one place."""

    def __init__(self, explica, out, given):
        self.explica, self.out = explica, out
        self.folders = [f"{folder}/" for folder in (out, *given)]

    def __truediv__(self, name):
        return self.out / name

    def call(self, words):
        command = [self.explica, *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise SystemExit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr}")

    def run(self, name, *words):
        self.call([*words, "--out", self / name, "--force", "--quiet"])
        command = "explica " + " ".join(map(str, words))
        for folder in self.folders:
            command = command.replace(folder, "")
        return Run(self / name, command)

    def strip(self, files, direction, size=215, region=None):
        """Pictures of surfaces from one side, in a row."""
        for file in files:
            self.call(["view", file, "--direction", direction, "--width", size, "--height", size,
                       *(["--labels", region] if region else []), "--screenshot", self / "view.png"])
            yield thesis_figures.picture((self / "view.png").read_bytes(), "png")


def rows_of(name):
    with open(Path(__file__).with_name(name), newline="") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))


class Page:
    """Sections with figures and numbers; every figure of the thesis is named once."""

    def __init__(self):
        self.body, self.figures, self.kept = [], [], []
        self.captions = {row["figures"]: row["caption"] for row in rows_of("thesis_captions.tsv")}
        self.reported = {row["key"]: row for row in rows_of("thesis_numbers.tsv")}

    def section(self, title):
        self.body.append(f"<h2>{title}</h2>")

    def figure(self, figures, pictures, run=None, **values):
        """figures: the thesis's figures that this one is, "3.1, 3.2", or its title."""
        named = figures.split(", ") if figures[0].isdigit() else []
        self.figures += named
        command = f"<code>{html.escape(run.command)}</code>" if run else ""
        self.body.append(f'<figure id="f{named[0] if named else ""}"><div>{"".join(pictures)}</div><figcaption>'
                         f'<b>{"Figure " if named else ""}{figures}.</b> '
                         f"{self.captions[figures].format(run=run, **values)} {command}</figcaption></figure>")

    def table(self, head, rows):
        lines = ["<th>".join(["", *head]), *("<td>".join(["", *map(str, row)]) for row in rows)]
        self.body.append(f"<div class=scroll><table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table></div>")

    def numbers(self, suffix="", **ours):
        """Numbers beside the thesis's, which a test bounds, by their keys."""
        self.kept += [{**self.reported[key + suffix], "ours": value} for key, value in ours.items()]

    def write(self, out, seconds):
        (out / "thesis.json").write_text(json.dumps(
            {"numbers": self.kept, "figures": dict.fromkeys(self.figures, "made"), "seconds": seconds}, indent=1))
        body, self.body = "".join(self.body), []
        self.table(["number", "thesis", "here", "figure"],
                   [[html.escape(n["what"]), n["thesis"], n["shown"].format(n["ours"]),
                     f"<a href='#f{n['figure']}'>{n['figure']}</a>"] for n in self.kept])
        (out / "thesis.html").write_text(PAGE.format(count=len(self.figures), seconds=seconds, body=body,
                                                     numbers=self.body[0]))


def ellipse_and_circle(path, spacing=0.5):
    """The region of figure 3.2, between an ellipse and a circle, as an image of one slice."""
    x, y = numpy.meshgrid(*2 * [numpy.arange(-38, 38, spacing)], indexing="ij")
    labels = numpy.where((x / 34) ** 2 + (y / 22) ** 2 < 1, 2, 0)
    labels[(x - 7) ** 2 + y ** 2 < 11.3 ** 2] = 1
    nibabel.save(nibabel.Nifti1Image(labels[..., None].astype(numpy.uint8), numpy.diag([spacing, spacing, 1, 1])), path)


def write_surface(path, radius, count=2562):
    """A closed surface about the origin, radius(x, y, z) mm in each direction, on a spiral of points."""
    z = numpy.linspace(1, -1, count + 2)[1:-1]
    turn = math.pi * (3 - math.sqrt(5)) * numpy.arange(count)
    v = numpy.stack([numpy.sqrt(1 - z * z) * numpy.cos(turn), numpy.sqrt(1 - z * z) * numpy.sin(turn), z], 1)
    f = scipy.spatial.ConvexHull(v).simplices
    inward = numpy.linalg.det(v[f]) < 0
    f[inward] = f[inward][:, ::-1]
    with open(path, "w") as file:
        file.write(f"OFF\n{len(v)} {len(f)} 0\n")
        numpy.savetxt(file, v * radius(*v.T)[:, None], fmt="%.6f")
        numpy.savetxt(file, numpy.insert(f, 0, 3, axis=1), fmt="%d")


def data(path):
    return numpy.squeeze(numpy.asarray(nibabel.load(path).dataobj, dtype=float))


def points_of(path):
    return numpy.loadtxt(path, delimiter=",", skiprows=1)


def columns_of(path):
    """A table's columns by name; what is no number is NaN."""
    table = numpy.genfromtxt(path, delimiter="\t", names=True, deletechars="")
    return {name: numpy.atleast_1d(table[name]) for name in table.dtype.names}


def from_to(run, *keys):
    return [f"{run[f'{key}_initial']:.3f} to {run[f'{key}_final']:.3f}" for key in keys]


# ---- chapters -----------------------------------------------------------------------------------

def correspondences(work, page, heart):
    page.section("3.1 Correspondences in annular tissue")
    ellipse_and_circle(work / "ellipse.nii.gz")
    ellipse = work.run("ellipse", "thickness", work / "ellipse.nii.gz", "--inner", 1, "--tissue", 2)
    page.figure("3.1, 3.2", thesis_figures.annular_field(ellipse.folder), ellipse)
    labels = heart or work.run("ventricle", "phantom", "ventricle", "--size", 64, "--spacing", 1.8) / "labels.nii.gz"
    wall = work.run("myocardium", "thickness", labels, "--inner", 1, "--tissue", 2, "--per-slice", "--cells", 4)
    page.figure("3.3", thesis_figures.annular_field(wall.folder, wall / "grid.vtu"), wall)
    page.numbers(grid_cells_degenerate=wall["grid_cells_degenerate"])


def appendix_a(work, page):
    page.section("Appendix A: the hybrid, and its dial")
    truth = work.run("spheroid", "phantom", "spheroid", "--size", 64, "--spacing", 2)
    levels = [word for side in ("inner", "outer") for word in (f"--{side}-level", truth / f"{side}_level.nii.gz")]

    def measure(method, width=None):
        run = work.run("hybrid", "thickness", *levels, "--sulci", "ignore", "--method", method,
                       *([] if width is None else ["--lambda", width]))
        ours, exact = ({name: data(folder / f"{name}.nii.gz") for name in ("thickness", "inner_point", "outer_point")}
                       for folder in (run, truth))
        tissue = (ours["thickness"] > 0) & (exact["thickness"] > 0)
        error = {name: abs(ours[name] - exact[name])[tissue] for name in ours}
        return {"boundary points, mm": 0.5 * sum(norm(error[f"{s}_point"], axis=1).mean() for s in ("inner", "outer")),
                "thickness, mm": error["thickness"].mean(), "ms": 1000 * run["seconds_correspondence"],
                "followed": run["traced_fraction"]}

    dial = [0.2, 0.5, 1, 1.5, 2, 3, math.inf]
    found = {method: [(width, measure(method, width)) for width in dial] for method in ("appendix-a", "hybrid")}
    for method in ("lagrangian", "eulerian"):
        found[method] = [(width, measure(method)) for width in (dial[0], dial[-1])]
    charts = {key: {method: [row[key] for _, row in rows] for method, rows in found.items()}
              for key in ("boundary points, mm", "ms")}
    page.figure("Error and time over λ", [
        thesis_figures.chart([(method, colour, [width for width, _ in found[method]], y) for (method, y), colour in
                              zip(curves.items(), (RED, BLUE, GREY, "#b98a00"))], "λ, mm", key)
        for key, curves in charts.items()])
    page.table(["method", "λ, mm", *found["hybrid"][0][1]],
               [[method, width, *(f"{value:.4g}" for value in row.values())]
                for method, rows in found.items() for width, row in rows])
    errors = charts["boundary points, mm"]
    page.numbers(appendix_a_dial=errors["appendix-a"][-1] / errors["appendix-a"][0],
                 hybrid_worst=max(errors["hybrid"]) / errors["lagrangian"][0])


def embedding(work, page):
    page.section("3.2 Harmonic embedding")
    annulus = ["--center", "0,0,0", "--inner-radius", 21, "--outer-radius", 40, "--order", 8, "--cells", 56]
    side, fits = "0.5,-0.75,0.45", []
    for name, number, start, radius in (
            ("cube", "3.4", 0.15, lambda x, y, z: 30 * (1 - 0.3 * (x ** 4 + y ** 4 + z ** 4 - 0.6))),
            ("pear", "3.5", 0.85, lambda x, y, z: 30 * (1 + 0.13 * z + 0.12 * (x * x - y * y)))):
        surface = work / f"{name}.off"
        write_surface(surface, radius)
        fit = work.run(name, "embed", surface, "--fit", *annulus, "--samples", 1000, "--fit-start", start)
        fits.append(fit / "coefficients.json")
        page.figure(number, work.strip([*fit.frames(), surface], side, 320), fit)
        page.numbers(**{f"fit_{name}": fit["distance_max"] / fit["voxel"]})
    average = work.run("average", "embed", *fits, "--average", "--cells", 56)
    series = [work.run(f"series{k}", "embed", *fits, "--combine", f"{1 - k / 8},{k / 8}", "--cells", 56)
              for k in range(9)]
    for number, runs in (("3.6", [series[0], average, series[-1]]), ("3.7", series)):
        page.figure(number, work.strip([run / "shape.surf.gii" for run in runs], side, 320), runs[len(runs) // 2])
    page.numbers(series_margin=min(run["boundary_margin"] for run in series))
    t = numpy.linspace(0, 2 * math.pi, 400, endpoint=False)
    for radii in ((18, 22), (15, 25)):
        files = [work / f"circle{r}.csv" for r in radii]
        for file, r in zip(files, radii):
            numpy.savetxt(file, r * numpy.stack([numpy.cos(t), numpy.sin(t)], 1), delimiter=",", fmt="%.6f")
        circle = work.run("circles", "embed", *files, "--average", "--center", "0,0,0", "--inner-radius", 12.5,
                          "--outer-radius", 29)
        off = abs(norm(points_of(circle / "shape.csv"), axis=1) - math.sqrt(math.prod(radii))).max()
        page.numbers(**{"circles_%d_%d" % radii: float(off)})


def definitions_in_the_plane(work, page, p34):
    """Figures 4.10 to 4.12 and 4.16: what is seen from a point, and the flux of a point and of an edge."""
    polygon, edges = points_of(p34 / "polygon.csv"), range(p34["region_edges"])
    svg, count, share = thesis_figures.visible_parts(polygon, edges)
    page.figure("4.10", [svg], count=count, share=share)
    svg, values = thesis_figures.region_of_interest(polygon, edges)
    page.figure("4.11", [svg], told=", ".join(f"{name} {flux:+.2f} ({'seen' if seen else 'not seen'})"
                                              for name, (flux, seen) in values.items()))
    page.numbers("_4.11", hidden=values["e"][0], away=values["d"][0], points=values["g"][0] - values["c"][0])
    page.figure("4.12", [thesis_figures.flux_of_a_point()])
    eye, length, drawn, totals, apart = numpy.array([0.0, 60.0]), 40, [], [], 0
    for angle in (0, math.radians(55)):
        svg, total, (a, b) = thesis_figures.edge_and_rays(length, angle, eye)
        drawn, totals = [*drawn, svg], [*totals, total]
        numpy.savetxt(work / "edge.csv", [a, b, 0.5 * (a + b) - [0, 200]], delimiter=",", fmt="%.12g")
        run = work.run("edge", "polygon", work / "edge.csv", "--region", "0:1", "--viewpoint", "0,60",
                       "--max-iterations", 1)
        apart = max(apart, abs(run["visibility_initial"] * length - total))
    page.figure("4.16", drawn, run, totals=totals)
    page.numbers(edge_flux=apart, edge_gain=totals[0] / totals[1])


def polygons(work, page):
    def polygon(edges, *words):
        return work.run(f"polygon{edges}" + "".join(map(str, words)).replace("--", "-"), "polygon", "--phantom",
                        f"polygon{edges}", *words)

    literal = ["--method", "thesis", "--no-collision"]
    ours, flow = ({n: polygon(n, *words) for n in (19, 34)} for words in ([], literal))
    page.section("4.1 Global measures")
    start, edges = points_of(ours[19] / "polygon.csv"), range(ours[19]["region_edges"])
    for measure, number, most in (("arc", "4.8", 600), ("occlusion", "4.9", 2000)):
        states = thesis_flows.polygon_flow(start, measure, most)
        page.figure(number, thesis_figures.flow_states(states, edges))
        lengths = [thesis_figures.length_of(p, edges) for p in (states[-1], start)]
        page.numbers(**{f"length_kept_{measure}": lengths[0] / lengths[1]})
    page.section("4.2 Unfolding of polygons")
    definitions_in_the_plane(work, page, ours[34])
    half = polygon(19, *literal, "--target-visibility", 0.4)
    collapse = polygon(34, *literal, "--no-length")
    fine, coarse = (polygon(34, "--method", "thesis", "--no-topology", "--explicit-step", *step)
                    for step in ((0.1, "--stages", 9), (1,)))
    for number, run in (("4.13, 4.15, 4.17", ours[19]), ("4.18", flow[34]), ("4.19", collapse), ("4.20", fine)):
        page.figure(number, [thesis_figures.picture((run / "evolution.svg").read_bytes(), "svg+xml")], run)
    page.figure("4.14", [thesis_figures.seen_region(points_of(half / "unfolded.csv"), range(half["region_edges"]),
                                                    numpy.array(half["viewpoint"]))], half)
    page.table(["region", "method", "visibility", "seen", "seen times cosine", "flux variance", "length, px", "iterations",
                "ms", "ms for the topology", "crossings"],
               [[f"{n} edges", method, *from_to(run, "visibility", "seen", "real_visibility", "flux_variance", "length"),
                 run["iterations"], f"{1000 * run['seconds']:.0f}", f"{1000 * run['seconds_topology']:.0f}",
                 run["self_intersections_final"]]
                for method, runs in (("ours", ours), ("explicit", flow)) for n, run in runs.items()])
    page.numbers(flux_40=half["visibility_final"], real_40=half["real_visibility_final"] - half["visibility_final"],
                 real_19=ours[19]["real_visibility_initial"] - ours[19]["visibility_initial"])
    change = lambda run: abs(run["length_final"] / run["length_initial"] - 1)
    for n, run in ours.items():
        page.numbers(f"_{n}", region_seen=polygon(n, "--region", "seen", "--max-iterations", 1)["region_edges"],
                     visibility_initial=run["visibility_initial"], variance_initial=run["flux_variance_initial"],
                     visibility_final=run["visibility_final"], variance_final=run["flux_variance_final"],
                     length=change(run), length_explicit=change(flow[n]),
                     knot_alone=flow[n]["self_intersections_final"] + max(0, flow[n]["first_crossing"]),
                     seconds=run["seconds"])
    page.numbers("_collapse", length=collapse["length_final"], edges=34 - collapse["vertices_merged"],
                 visibility=collapse["visibility_final"])
    page.numbers(first_crossing=fine["first_crossing"], first_crossing_coarse=coarse["first_crossing"])


def clear_visibility(work, before, run):
    """Visibility of the last of a run's frames before one with crossing faces."""
    crossings = [0] * len(run["frame_visibilities"])
    if run["self_intersections_frames_max"] > 0:
        compared = work.run("compared", "compare", before, *run.frames(), "--pairs", 100, "--sources", 4)
        crossings = columns_of(compared / "comparison.tsv")["crossings"]
    clear = itertools.takewhile(lambda frame: frame[0] == 0, zip(crossings, run["frame_visibilities"]))
    return [run["visibility_initial"], *(visibility for _, visibility in clear)][-1]


def steps_judged(run):
    """How many steps of a run have one of its frames between their start and their end, by visibility."""
    steps, frames = columns_of(run / "evolution.tsv")["visibility"], run["frame_visibilities"]
    return sum(any(a <= v <= b for v in frames) for a, b in zip(steps, steps[1:]))


def definitions_in_space(work, page, folds):
    """Figures 5.21 to 5.23: region and viewpoint, a face's corners, the merging tree."""
    page.section("5.1 and 5.4 Region, face and tree")
    page.figure("5.21", [picture for side in ("0,-0.3,1", "0.45,-1,0.75") for picture in
                         work.strip([folds / "folds.surf.gii"], side, 430, folds / "region.label.gii")])
    svg, before = thesis_figures.face_with_normal()
    page.figure("5.22", [svg], before=before)
    tree = thesis_figures.MergingTree([0, 1, 4, 5.2, 6.8, 10, 11.4, 15, 16.6])
    drawings, starts = zip(thesis_figures.draw_tree(tree, "(a) the tree of nine faces"),
                           *(thesis_figures.draw_tree(tree, f"({letter}) forces on face {face}", face, near)
                             for letter, face, near in (("b", 1, [2]), ("c", 4, [3, 5]), ("d", 6, [5, 7]))))
    page.figure("5.23", drawings)
    page.numbers(tree_nodes=max(tree.centre), tree_three=len(tree.children[11]), tree_start=starts[1][0])


def folded_sheet(work, page):
    page.section("5.6 A synthetic surface")
    folds, above, side = work.run("folds", "phantom", "folds", "--edge", 1), "0,0,1", "0.45,-1,0.75"
    region = folds / "region.label.gii"
    ours = work.run("folds-open", "unfold", folds / "folds.surf.gii", "--label", region, "--direction", above,
                    "--frames", 5)
    page.figure("5.24", work.strip(ours.frames(), side, region=region), ours)
    page.numbers(folds_initial=ours["visibility_initial"], folds_final=ours["visibility_final"],
                 folds_crossings=ours["self_intersections_final"])

    page.section("5.3 and 5.4 The thesis's own flow in space")
    coarse = work.run("coarse", "phantom", "folds", "--edge", 2.5, "--length", 60, "--waves", 3)
    surface = coarse / "folds.surf.gii"

    def flow(surround, knot, weight, iterations=200):
        return work.run(f"flow-{surround}-{knot}-{weight:g}", "unfold", surface, "--label", coarse / "region.label.gii",
                        "--direction", above, "--method", "thesis", "--surround", surround, "--knot", knot,
                        "--knot-weight", weight, "--max-iterations", iterations, "--frames", 12)

    literal = flow("none", "thesis-tree", 0.03)
    reached = clear_visibility(work, surface, literal)
    page.figure("The flow as the thesis has it", work.strip([literal.frames()[k] for k in (0, 3, 6, 9, 11)], side), literal,
                reached=reached)
    weights = [0.01, 0.03, 0.1]
    best = {surround: [clear_visibility(work, surface, flow(surround, "tree", w)) for w in weights]
            for surround in ("none", "fixed")}
    page.figure("The limit of the knot energy alone",
                [thesis_figures.chart([(name, colour, weights, best[name]) for name, colour in
                                       (("none", BLUE), ("fixed", RED))], "weight of the knot energy",
                                      "visibility without a crossing", y_log=False)])
    page.numbers(literal_final=literal["visibility_final"], literal_clear=reached,
                 **{f"flow_limit_{name}": max(reached) for name, reached in best.items()})
    times = {}
    for knot in ("all-pairs", "thesis-tree", "tree"):
        run = flow("fixed", knot, 0.01, 2)
        times[f"seconds_{knot}"] = run["seconds_repulsion"] / max(1, run["iterations"])
    pairs, theirs, mine = times.values()
    page.numbers(**times, tree_gain=pairs / theirs, our_gain=theirs / mine)
    definitions_in_space(work, page, folds)


def cortex(work, page, fsaverage):
    page.section("5.6 Regions of a cortex")
    if fsaverage:
        surface, radius = fsaverage / "pial_left.gii.gz", 25
        directions = {"5.25": (-1, 0.2, 0.2), "5.26": (-0.2, -1, 0.3), "5.27": (-0.2, 0.1, 1)}
    else:
        labels = work.run("cortex", "phantom", "cortex", "--size", 40, "--depth", 0.3, "--waves", 4) / "labels.nii.gz"
        surface = work.run("cortex-surface", "surface", labels, "--white-label", 3, "--grey-label", 2, "--faces",
                           5000) / "mid.surf.gii"
        radius, directions = 9, {"5.25": (0, 0, 1), "5.26": (1, 0.2, 0.2), "5.27": (0, -1, 0.6)}
    positions, rows = nibabel.load(surface).darrays[0].data, []
    for number, direction in directions.items():
        towards = ",".join(f"{x:g}" for x in direction)
        aim = [surface, "--vertex", int((positions @ numpy.array(direction)).argmax()), "--radius", radius, "--direction",
               towards]
        ours = work.run(f"region-{number}", "unfold", *aim, "--frames", 4)
        flow = work.run(f"thesis-{number}", "unfold", *aim, "--surround", "none", "--method", "thesis", "--knot",
                        "thesis-tree", "--knot-weight", 0.2, "--max-iterations", 150, "--frames", 400)
        judged = steps_judged(flow)
        page.figure(number, work.strip(ours.frames(), towards, 270, ours / "region.label.gii"), ours)
        page.figure("By the thesis’s own flow", work.strip(flow.frames()[::133], towards, 270), flow, judged=judged,
                    ours=ours)
        page.numbers(f"_{number}", region=ours["visibility_final"], region_crossings=ours["self_intersections_new"],
                     thesis_region=flow["visibility_final"], thesis_steps=judged,
                     thesis_region_crossings=flow["self_intersections_frames_max"])
        rows += [[number, run["region_faces"], method, *from_to(run, "visibility", "real_visibility", "flux_variance"),
                  f"{run['area_error_mean']:.2%}", run["self_intersections_new"], run["iterations"],
                  f"{run['seconds_per_iteration']:.3f}"] for method, run in (("ours", ours), ("the thesis's", flow))]
    page.table(["figure", "faces", "method", "flux", "seen times cosine", "flux variance", "area error", "crossings",
                "iterations", "s an iteration"], rows)
    return surface, work / "region-5.25"


def comparison(work, page, fsaverage, surface, unfolded):
    page.section("Beside flat, inflated and spherical maps")
    if fsaverage:
        maps = {name: fsaverage / f"{name}_left.gii.gz" for name in ("infl", "sphere", "flat")}
    else:
        maps = {"inflated": work.run("inflated", "inflate", surface, "--target-seen", 0.998) / "inflated.surf.gii"}
    maps = {"unfolded": unfolded / "unfolded.surf.gii", **maps}
    compared = columns_of(work.run("beside", "compare", surface, *maps.values(), "--label", unfolded / "region.label.gii",
                                   "--pairs", 4000) / "comparison.tsv")
    shown = ["area_error_mean", "area_error_max", "edge_strain_mean", "angle_error_mean_deg", "geodesic_error_local",
             "geodesic_error_all", "turned_over", "crossings", "seen"]
    rows = {name: [float(compared[key][row]) for key in shown] for row, name in enumerate(maps, -len(maps))}
    page.table(["map of the region", *(key.replace("_", " ") for key in shown)],
               [[name, *("" if math.isnan(value) else f"{value:.3g}" for value in row)] for name, row in rows.items()])
    for name, row in rows.items():
        page.numbers(f"_{name}", area_error=row[0], strain=row[2])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("explica", "out", "fsaverage", "heart"):
        parser.add_argument(f"--{name}", type=lambda text: Path(text).resolve(), required=name in ("explica", "out"))
    given = parser.parse_args()
    (given.out / "runs").mkdir(parents=True, exist_ok=True)
    work = Work(given.explica, given.out / "runs", filter(None, [given.fsaverage, given.heart and given.heart.parent]))
    page, begin = Page(), time.monotonic()
    correspondences(work, page, given.heart)
    appendix_a(work, page)
    embedding(work, page)
    polygons(work, page)
    folded_sheet(work, page)
    comparison(work, page, given.fsaverage, *cortex(work, page, given.fsaverage))
    page.section("Errata of the thesis, each pinned by a test")
    page.table(["equation", "printed", "right", "test"], ERRATA)
    page.write(given.out, time.monotonic() - begin)
    print(f"look at {given.out / 'thesis.html'}", file=sys.stderr)


if __name__ == "__main__":
    main()
