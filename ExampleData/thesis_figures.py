# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The thesis's figures that explain: drawn anew from a polygon, an edge, a face and a tree, each with
the numbers that its own geometry gives; and charts.  Each picture is an <img> of its own."""

import base64
import io
import itertools
import math
import re

import matplotlib.figure
import nibabel
import numpy
from numpy.linalg import norm

from thesis_flows import cross

INK, GREY, PALE, BLUE, RED, GREEN = "#1a1d21", "#7a7f85", "#c9cdd2", "#145ab4", "#c0392b", "#2e8b57"
TO = {"arrowstyle": "-|>", "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0}


def picture(data, kind, alt="figure"):
    return f'<img alt="{alt}" src="data:image/{kind};base64,{base64.b64encode(data).decode()}">'


def drawn(axes):
    file = io.BytesIO()
    axes.figure.savefig(file, format="svg")
    return picture(file.getvalue(), "svg+xml")


def plane(low, high, width, title=""):
    """Axes over a rectangle of the plane, `width` pixels wide."""
    low, high = numpy.asarray(low, float), numpy.asarray(high, float)
    across, up = (high - low) / (high - low)[0] * width / 72
    axes = matplotlib.figure.Figure(figsize=(across, up)).add_axes((0, 0, 1, 1))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.axis("off")
    axes.text(0.03, 0.03, title, transform=axes.transAxes)
    return axes


def chart(series, x_label, y_label, y_log=True):
    """Lines with marks; series: (name, colour, x, y).  Infinite x are drawn at the right."""
    axes = matplotlib.figure.Figure(figsize=(5.6, 3.6), layout="tight").subplots()
    axes.set(xscale="log", yscale="log" if y_log else "linear", xlabel=x_label, ylabel=y_label)
    finite = sorted({x for _, _, places, _ in series for x in places if math.isfinite(x)})
    for (name, colour, x, y), mark in zip(series, "osD^"):
        axes.plot(numpy.minimum(x, 2 * finite[-1]), y, f"{mark}-", color=colour, label=name)
    beyond = [2 * finite[-1]] if any(math.inf in places for _, _, places, _ in series) else []
    axes.set_xticks([*finite, *beyond], [*(f"{x:g}" for x in finite), *("∞" for _ in beyond)])
    axes.set_xticks([], minor=True)
    axes.grid(color="#e4e6e8")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False)
    return drawn(axes)


# ---- the plane ----------------------------------------------------------------------------------

def inward_normal(way):
    """Of edges of a counter-clockwise polygon."""
    return numpy.stack([-way[..., 1], way[..., 0]], -1) / norm(way, axis=-1, keepdims=True)


def flux_at(place, normal, eye):
    """(4.8): unit ray times the inward unit normal."""
    ray = place - eye
    return numpy.sum(ray * normal, -1) / norm(ray, axis=-1)


def region_of(polygon, edges):
    """The vertices (E + 1, 2) of a stretch of edges."""
    return polygon[[edges[0], *((k + 1) % len(polygon) for k in edges)]]


def length_of(polygon, edges):
    return float(norm(numpy.diff(region_of(polygon, edges), axis=0), axis=1).sum())


def samples(polygon, edges, eye, apart=0.4):
    """Points along edges (S, 2), their flux, and whether the eye sees them: that they face it and no other
    edge is between."""
    way = numpy.roll(polygon, -1, axis=0) - polygon
    counts = [max(2, int(norm(way[k]) / apart)) for k in edges]
    edge, share = numpy.repeat(edges, counts), numpy.concatenate([(numpy.arange(c) + 0.5) / c for c in counts])
    place = polygon[edge] + share[:, None] * way[edge]
    flux, ray = flux_at(place, inward_normal(way[edge]), eye), (place - eye)[:, None]
    with numpy.errstate(divide="ignore", invalid="ignore"):
        along_ray = cross(polygon - eye, way) / cross(ray, way)
        along_edge = cross(polygon - eye, ray) / cross(ray, way)
    hides = (along_ray > 1e-9) & (along_ray < 1 - 1e-9) & (along_edge >= 0) & (along_edge <= 1)
    hides[numpy.arange(len(edge)), edge] = False
    return place, flux, (flux > 0) & ~hides.any(axis=1)


def stretches(seen):
    """The samples of each stretch that is seen."""
    cuts = numpy.flatnonzero(numpy.diff(seen)) + 1
    return [run for run in numpy.split(numpy.arange(len(seen)), cuts) if seen[run[0]]]


def near_viewpoint(polygon, edges):
    """Of viewpoints around the region's upper side the one that sees it in most pieces."""
    region = polygon[edges]
    angles = numpy.radians(numpy.arange(25, 160, 5))[:, None]
    eyes = 0.5 * (region.min(0) + region.max(0)) + 130 * numpy.hstack([numpy.cos(angles), numpy.sin(angles)])
    return max(eyes, key=lambda eye: len(stretches(samples(polygon, edges, eye, 1.5)[2])))


def before_an_eye(polygon, eye, width=470):
    points = numpy.vstack([polygon, eye])
    axes = plane(points.min(0) - 16, points.max(0) + 16, width)
    axes.fill(*polygon.T, facecolor="#f4f5f6", edgecolor=GREY)
    mark_eye(axes, eye)
    return axes


def mark_eye(axes, eye):
    axes.plot(*eye, "o", color=RED)
    axes.annotate("P", eye, (8, 4), textcoords="offset points", color=RED, style="italic", size=14)


def visible_parts(polygon, edges):
    """Figure 4.10: the stretches that a near viewpoint sees; how many there are, and their share."""
    eye = near_viewpoint(polygon, edges)
    place, _, seen = samples(polygon, edges, eye)
    axes, names = before_an_eye(polygon, eye), iter("abcdefghijklmnopqrstuvwxyz")
    for run in stretches(seen):
        axes.plot(*place[run].T, color=BLUE, linewidth=4)
        for end in run[[0, -1]]:
            axes.plot(*numpy.stack([eye, place[end]]).T, color=PALE, linewidth=1)
        for end in run[[0, -1]] if len(run) > 11 else run[:1]:
            axes.annotate(next(names), place[end], (0, 5), textcoords="offset points", style="italic")
    return drawn(axes), len(stretches(seen)), float(seen.mean())


def region_of_interest(polygon, edges):
    """Figure 4.11: flux of points that are seen, g and c, and of points that are not, e and d."""
    eye, region = near_viewpoint(polygon, edges), region_of(polygon, edges)
    place, flux, seen = samples(polygon, edges, eye)
    inner = numpy.minimum(norm(place - region[0], axis=1), norm(place - region[-1], axis=1)) > 20
    where = {"g": numpy.where(seen, flux, -2).argmax(), "c": numpy.where(seen, abs(flux - 0.35), 2).argmin(),
             "e": numpy.where(seen | ~inner, -2, flux).argmax()}
    where["d"] = numpy.where(inner & (norm(place - place[where["e"]], axis=1) > 25), flux, 2).argmin()
    axes = before_an_eye(polygon, eye)
    axes.plot(*region.T, color=BLUE, linewidth=2.6)
    for name, point, colour in [("a", region[0], BLUE), ("b", region[-1], BLUE),
                                *((name, place[n], GREEN if seen[n] else RED) for name, n in where.items())]:
        axes.plot(*point, "o", color=colour)
        axes.annotate(name, point, (7, 4), textcoords="offset points", color=colour, style="italic")
        if name in where:
            axes.plot(*numpy.stack([eye, point]).T, "-" if seen[where[name]] else "--", color=colour, linewidth=1)
    return drawn(axes), {name: (float(flux[n]), bool(seen[n])) for name, n in where.items()}


def seen_region(polygon, edges, eye):
    """Figure 4.14: a region and what is seen of it from afar."""
    place, _, seen = samples(polygon, edges, eye)
    top = numpy.array([polygon[:, 0].mean(), polygon[:, 1].max() + 52])
    axes = plane(polygon.min(0) - 14, [polygon[:, 0].max() + 14, top[1] + 8], 430)
    axes.fill(*polygon.T, facecolor="#f4f5f6", edgecolor=GREY)
    axes.plot(*region_of(polygon, edges).T, color=RED)
    for run in stretches(seen):
        axes.plot(*place[run].T, color=BLUE, linewidth=4)
    axes.annotate("to P, far above", top, top - [0, 30], ha="center", arrowprops=TO)
    return drawn(axes)


def flux_of_a_point():
    """Figure 4.12: ray, inward normal and the cosine between them."""
    t = numpy.linspace(0.16 * math.pi, 0.9 * math.pi, 90)
    curve, n, eye = numpy.stack([90 * numpy.cos(t), 55 * numpy.sin(t)], 1), 36, numpy.array([78.0, 118.0])
    point, normal = curve[n], inward_normal(curve[n + 1] - curve[n - 1])
    ray = (point - eye) / norm(point - eye)
    flux = float(flux_at(point, normal, eye))
    axes = plane([-96, 4], [112, 130], 430, f"flux = cos θ = {flux:.3f}")
    axes.plot(*curve.T, color=BLUE, linewidth=2.6)
    axes.plot(*numpy.stack([eye, point + 34 * ray]).T, "--", color=GREY)
    for end, start, words in ((point, point - 34 * ray, "unit ray"), (point + 34 * normal, point, "N, inward")):
        axes.annotate("", end, start, arrowprops=TO)
        axes.annotate(words, (start + end) / 2, (8, 0), textcoords="offset points")
    axes.annotate("θ", point + 16 * (ray + normal) / norm(ray + normal), color=GREEN, style="italic")
    mark_eye(axes, eye)
    return drawn(axes)


def edge_and_rays(length, angle, eye):
    """Figure 4.16: an edge about the origin, its rays, and its flux by quadrature."""
    a = 0.5 * length * numpy.array([math.cos(angle), math.sin(angle)])
    normal = inward_normal(-2 * a)  # counter-clockwise, its outer side up
    x, w = numpy.polynomial.legendre.leggauss(40)
    total = float(0.5 * length * w @ flux_at(x[:, None] * a, normal, eye))
    axes = plane([-44, -44], [44, eye[1] + 12], 300, f"total flux {total:.2f} of length {length:g}")
    for q in numpy.linspace(-1, 1, 9):
        axes.plot(*numpy.stack([eye, q * a]).T, color=PALE, linewidth=1)
    axes.plot(*numpy.stack([a, -a]).T, color=BLUE, linewidth=4)
    axes.annotate("", 18 * normal, (0, 0), arrowprops=TO)
    mark_eye(axes, eye)
    return drawn(axes), total, (a, -a)


def flow_states(states, edges, count=6):
    """A region on its way, at lengths that are evenly apart."""
    lengths = numpy.array([length_of(p, edges) for p in states])
    low, high = numpy.min(states, axis=(0, 1)) - [4, 24], numpy.max(states, axis=(0, 1)) + 4
    wanted = numpy.linspace(lengths[0], lengths[-1], count)
    for n in sorted({int(abs(lengths - w).argmin()) for w in wanted}):
        axes = plane(low, high, 240, f"iteration {n}, length {lengths[n]:.0f}")
        axes.fill(*states[n].T, facecolor="#f4f5f6", edgecolor=GREY)
        axes.plot(*region_of(states[n], edges).T, color=BLUE)
        yield drawn(axes)


# ---- space --------------------------------------------------------------------------------------

def face_with_normal():
    """Figure 5.22: a face, the order of its corners and its inward unit normal (69), and its side to the eye."""
    corners, eye = numpy.array([[0, 0, 0], [52, 6, 4], [17, 40, 10]], float), numpy.array([26.0, 20.0, 74.0])
    inward = -numpy.cross(*(corners[1:] - corners[0]))
    inward /= norm(inward)
    flat = lambda p: numpy.asarray(p) @ [[1, 0], [0.35, 0.42], [0, 0.8]]
    axes, centre = plane([-12, -38], [88, 78], 400), corners.mean(0)
    axes.fill(*flat(corners).T, facecolor="#e3ecf7", edgecolor=BLUE, linewidth=2.4)
    for name, corner in zip("abc", corners):
        axes.plot(*flat([eye, corner]).T, color=PALE, linewidth=1)
        axes.annotate("v" + name, flat(corner), flat(corner + 0.18 * (corner - centre)), style="italic", size=13)
    axes.annotate("N, inward", flat(centre), flat(centre + 28 * inward), arrowprops={**TO, "arrowstyle": "<|-"})
    for start, end in itertools.pairwise(flat(0.55 * centre + 0.45 * corners)):
        axes.annotate("", end, start, arrowprops={**TO, "color": GREEN, "connectionstyle": "arc3,rad=0.4"})
    mark_eye(axes, flat(eye))
    return drawn(axes), float((corners[0] - eye) @ inward)


class MergingTree:
    """The merging algorithm of section 5.4 for faces in a row; nodes are numbered from 1 as in the figure."""

    def __init__(self, centres):
        self.children, self.parent = {}, {}
        self.centre = dict(enumerate(centres, 1))
        self.faces = {n: 1 for n in self.centre}
        level = sorted(self.centre)
        while len(level) > 1:  # nodes of a level are in a row, too: neighbours are those beside
            level = self.merge(level)

    def merge(self, level):
        group = {}
        pairs = sorted(zip(level, level[1:]), key=lambda pair: self.centre[pair[1]] - self.centre[pair[0]])
        for a, b in pairs:  # steps 3 and 4
            if a not in group and b not in group:
                group[a] = group[b] = [a, b]
        for a, b in pairs:  # steps 5 and 6
            for one, other in ((a, b), (b, a)):
                if one not in group:
                    group[one] = group[other]
                    group[one].append(one)
        made = []
        for members in sorted({min(g): sorted(g) for g in group.values()}.values()):
            node = max(self.centre) + 1
            self.children[node] = members
            self.parent.update(dict.fromkeys(members, node))
            self.faces[node] = sum(self.faces[c] for c in members)
            self.centre[node] = sum(self.faces[c] * self.centre[c] for c in members) / self.faces[node]
            made.append(node)
        return made

    def below(self, node):
        return {node}.union(*(self.below(c) for c in self.children.get(node, [])))

    def starts(self, face, near):
        """Nodes at which the recursion for a face's forces begins, and those visited before (5.23b to d)."""
        visited, found = set(), []
        for n in (face, *near):
            while n:
                visited.add(n)
                n = self.parent.get(n)
        left = set(self.centre) - visited
        while left:
            found.append(max(left))
            left -= self.below(max(left))
        return found, visited


def draw_tree(tree, title, face=None, near=()):
    starts, visited = tree.starts(face, near) if face else ([], set())
    spot = {}
    for n in sorted(tree.centre):
        below = [spot[c] for c in tree.children.get(n, [])]
        spot[n] = (numpy.mean([x for x, _ in below]), 1 + max(y for _, y in below)) if below else (n, 0)
    axes = plane([0.2, -0.75], [9.8, 3.75], 460, title)
    for child, parent in tree.parent.items():
        if parent not in visited:
            axes.plot(*zip(spot[child], spot[parent]), color=GREY, zorder=0)
    for n in spot:
        if n in visited and n in tree.children:
            continue  # a path to the root: deleted
        fill = GREY if n == face else "#f3c9a5" if n in near else "#cfe3cf" if n in starts else "#fff"
        axes.text(*spot[n], n, ha="center", va="center", bbox={"boxstyle": "circle", "facecolor": fill})
    return drawn(axes), starts


# ---- annular tissue -----------------------------------------------------------------------------

def grid_cells(path):
    """Points (P, 3) and cells (C, 4 or 8) of a .vtu of `explica thickness --cells`."""
    head, _, raw = path.read_bytes().partition(b'<AppendedData encoding="raw">\n_')

    def array(name):
        kind, offset = re.search(rf'type="(\w+)" Name="{name}".*?offset="(\d+)"', head.decode()).groups()
        size = int.from_bytes(raw[int(offset) : int(offset) + 8], "little")
        return numpy.frombuffer(raw, {"Int32": "<i4", "Float64": "<f8"}[kind], size // int(kind[-2:]) * 8,
                                int(offset) + 8)

    return array("Points").reshape(-1, 3), array("connectivity").reshape(len(array("offsets")), -1)


def annular_field(folder, cells=None):
    """The slice with most tissue: u, its tangent field, trajectories, and the grid of a .vtu."""
    data = {name: nibabel.load(folder / f"{name}.nii.gz") for name in ("harmonic", "thickness", "inner_point", "outer_point")}
    affine, spacing = data["harmonic"].affine, norm(data["harmonic"].affine[:2, :2], axis=0)
    data = {name: numpy.asarray(image.dataobj, float).squeeze() for name, image in data.items()}
    k = 0
    if data["harmonic"].ndim == 3:
        k = int((data["thickness"] > 0).sum(axis=(0, 1)).argmax())
        data = {name: values[:, :, k] for name, values in data.items()}
    place = lambda world: (numpy.linalg.inv(affine) @ [*world.T, numpy.ones(len(world))])[:2].T * spacing
    tissue = data["thickness"] > 0
    u = numpy.where(tissue, data["harmonic"], numpy.nan)
    x, y = (numpy.arange(n) * h for n, h in zip(u.shape, spacing))
    tangent = numpy.stack(numpy.gradient(u, *spacing), -1)
    tangent /= norm(tangent, axis=-1, keepdims=True)
    voxels = numpy.argwhere(tissue)
    low, high = (voxels.min(0) - 1.5) * spacing, (voxels.max(0) + 1.5) * spacing
    panels = [plane(low, high, 330) for _ in range(4 if cells else 3)]
    for axes in panels:
        axes.contourf(x, y, u.T, 10, cmap="YlGnBu", alpha=1 if axes is panels[0] else 0.15)
        for name, colour in (("inner_point", "#b01414"), ("outer_point", "#143c9c")):
            axes.plot(*place(data[name][tissue]).T, ".", color=colour, markersize=2)
    some = (slice(None, None, max(1, len(x) // 34)),) * 2
    panels[1].quiver(x[some[0]], y[some[0]], *tangent[some].transpose(2, 1, 0), pivot="mid", scale=40, width=0.003)
    middle = voxels[abs(u[tissue] - 0.5) < 0.15]
    around = numpy.argsort(numpy.arctan2(*((middle - middle.mean(0)).T)))
    panels[2].streamplot(x, y, *tangent.transpose(2, 1, 0), color="#0f6b3a", linewidth=1.2, arrowsize=0.7,
                         density=4, minlength=0.01, start_points=(middle * spacing)[around[:: max(1, len(around) // 48)]])
    if cells:
        points, corners = grid_cells(cells)
        near = abs(points @ numpy.linalg.inv(affine)[2, :3] + numpy.linalg.inv(affine)[2, 3] - k) <= 0.5
        sides = {tuple(sorted(pair)) for c in corners[:, :4] for pair in zip(c, numpy.roll(c, -1))}
        for pair in sides:
            if near[list(pair)].all():
                panels[3].plot(*place(points[list(pair)]).T, color="#333", linewidth=0.5)
    return [drawn(axes) for axes in panels]
