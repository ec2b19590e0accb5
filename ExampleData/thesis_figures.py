# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The thesis's figures that explain: drawn anew from a polygon, an edge, a face and a tree, each with
the numbers that its own geometry gives."""

import base64
import html
import math
import re

import nibabel
import numpy

INK, GREY, PALE, BLUE, RED, GREEN = "#1a1d21", "#7a7f85", "#c9cdd2", "#145ab4", "#c0392b", "#2e8b57"


class Drawing:
    """SVG in the coordinates of what is drawn: y up, `scale` pixels a unit."""

    def __init__(self, low, high, width):
        self.low, self.high = numpy.asarray(low, float), numpy.asarray(high, float)
        self.scale = width / (self.high[0] - self.low[0])
        self.size = self.scale * (self.high - self.low)
        self.parts = []

    def at(self, point):
        p = numpy.asarray(point, float)
        return self.scale * (p[0] - self.low[0]), self.scale * (self.high[1] - p[1])

    def line(self, points, colour=INK, width=1.5, closed=False, dash=None, fill="none", arrow=False):
        path = " ".join("%.1f,%.1f" % self.at(p) for p in points)
        more = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<{"polygon" if closed else "polyline"} points="{path}" fill="{fill}" '
                          f'stroke="{colour}" stroke-width="{width}" stroke-linejoin="round"{more}/>')
        if arrow:
            self.tip(points[-2], points[-1], colour)

    def tip(self, start, end, colour):
        """An arrow's head at the end of a line."""
        a, b = numpy.array(self.at(start)), numpy.array(self.at(end))
        along = (b - a) / numpy.linalg.norm(b - a)
        across = numpy.array([-along[1], along[0]])
        corners = " ".join("%.1f,%.1f" % tuple(p) for p in (b + 2 * along, b - 8 * along + 4.5 * across,
                                                            b - 8 * along - 4.5 * across))
        self.parts.append(f'<polygon points="{corners}" fill="{colour}"/>')

    def dot(self, point, colour=INK, radius=3.5):
        x, y = self.at(point)
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}"/>')

    def text(self, point, words, dx=0, dy=0, anchor="middle", colour=INK, size=13, style="normal"):
        x, y = self.at(point)
        self.parts.append(f'<text x="{x + dx:.1f}" y="{y + dy:.1f}" text-anchor="{anchor}" fill="{colour}" '
                          f'font-size="{size}" font-style="{style}">{html.escape(words)}</text>')

    def eye(self, point, name="P"):
        self.dot(point, RED, 5)
        self.text(point, name, 10, -6, "start", RED, 15, "italic")

    def svg(self):
        w, h = self.size
        return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w:.0f} {h:.0f}" width="{w:.0f}" '
                f'font-family="sans-serif"><rect width="100%" height="100%" fill="#fff"/>{"".join(self.parts)}</svg>')


# ---- the plane ----------------------------------------------------------------------------------

def inward_normal(a, b):
    """Of an edge of a counter-clockwise polygon."""
    d = b - a
    return numpy.array([-d[1], d[0]]) / numpy.linalg.norm(d)


def flux_at(point, normal, eye):
    """(4.8): unit ray times the inward unit normal."""
    ray = point - eye
    return float(ray @ normal / numpy.linalg.norm(ray))


def sees(polygon, edge, point, eye):
    """True if nothing of the polygon but the point's own edge stands between, and its front faces the eye."""
    a, b = polygon, numpy.roll(polygon, -1, axis=0)
    if flux_at(point, inward_normal(a[edge], b[edge]), eye) <= 0:
        return False
    d, e = point - eye, b - a
    cross = d[0] * e[:, 1] - d[1] * e[:, 0]
    with numpy.errstate(divide="ignore", invalid="ignore"):
        w = a - eye
        t = (w[:, 0] * e[:, 1] - w[:, 1] * e[:, 0]) / cross
        s = (w[:, 0] * d[1] - w[:, 1] * d[0]) / cross
    hits = (t > 1e-9) & (t < 1 - 1e-9) & (s >= 0) & (s <= 1)
    hits[edge] = False
    return not hits.any()


class Samples:
    """Points along the edges of a polygon, with flux and what the eye sees."""

    def __init__(self, polygon, edges, eye, apart):
        self.place, self.flux, self.seen, self.edge = [], [], [], []
        for k in edges:
            a, b = polygon[k], polygon[(k + 1) % len(polygon)]
            count = max(2, int(numpy.linalg.norm(b - a) / apart))
            for q in range(count):
                p = a + (q + 0.5) / count * (b - a)
                self.place.append(p)
                self.flux.append(flux_at(p, inward_normal(a, b), eye))
                self.seen.append(sees(polygon, k, p, eye))
                self.edge.append(k)
        self.place, self.flux, self.seen = map(numpy.array, (self.place, self.flux, self.seen))

    def runs(self):
        """First and last sample of each stretch that is seen."""
        found = []
        for n, seen in enumerate(self.seen):
            if seen and (n == 0 or not self.seen[n - 1]):
                found.append([n, n])
            elif seen:
                found[-1][1] = n
        return found


def near_viewpoint(polygon, edges):
    """Of viewpoints around the region's upper side the one that sees it in most pieces."""
    region = polygon[edges]
    middle, reach = 0.5 * (region.min(0) + region.max(0)), 130.0
    eyes = [middle + reach * numpy.array([math.cos(a), math.sin(a)]) for a in numpy.radians(range(25, 160, 5))]
    return max(eyes, key=lambda eye: len(Samples(polygon, edges, eye, 1.5).runs()))


def frame_about(polygon, eye):
    points = numpy.vstack([polygon, eye])
    return Drawing(points.min(0) - 16, points.max(0) + 16, 470)


def visible_parts(polygon, edges):
    """Figure 4.10: the stretches that a near viewpoint sees; and how many there are."""
    eye = near_viewpoint(polygon, edges)
    samples = Samples(polygon, edges, eye, 0.4)
    drawing = frame_about(polygon, eye)
    drawing.line(polygon, GREY, 1.4, closed=True, fill="#f4f5f6")
    names = iter("abcdefghijklmnopqrstuvwxyz")
    runs = samples.runs()
    for first, last in runs:
        drawing.line(samples.place[first:last + 1], BLUE, 4)
        for end in (first, last):
            drawing.line([eye, samples.place[end]], PALE, 1)
            drawing.dot(samples.place[end], BLUE, 2.5)
    for first, last in runs:
        for end in (first, last) if last - first > 10 else (first,):
            drawing.text(samples.place[end], next(names), 0, -7, size=12, style="italic")
    drawing.eye(eye)
    return drawing.svg(), len(runs), float(samples.seen.mean())


def region_of_interest(polygon, edges):
    """Figure 4.11: flux of points that are seen and of points that are not."""
    eye = near_viewpoint(polygon, edges)
    samples = Samples(polygon, edges, eye, 0.4)
    ends = polygon[edges[0]], polygon[(edges[-1] + 1) % len(polygon)]
    inner = numpy.min([numpy.linalg.norm(samples.place - end, axis=1) for end in ends], axis=0) > 20
    where = {"g": numpy.where(samples.seen, samples.flux, -2).argmax(),
             "c": numpy.where(samples.seen, abs(samples.flux - 0.35), 2).argmin(),
             "e": numpy.where(samples.seen | ~inner, -2, samples.flux).argmax()}
    apart = numpy.linalg.norm(samples.place - samples.place[where["e"]], axis=1) > 25
    where["d"] = numpy.where(inner & apart, samples.flux, 2).argmin()
    drawing = frame_about(polygon, eye)
    drawing.line(polygon, GREY, 1.4, closed=True, fill="#f4f5f6")
    region = [polygon[edges[0]], *(polygon[(k + 1) % len(polygon)] for k in edges)]
    drawing.line(region, BLUE, 2.6)
    for name, end in (("a", region[0]), ("b", region[-1])):
        drawing.dot(end, BLUE)
        drawing.text(end, name, 12, 5, style="italic")
    for name, n in where.items():
        colour = GREEN if samples.seen[n] else RED
        drawing.line([eye, samples.place[n]], colour, 1, dash=None if samples.seen[n] else "4 3")
        drawing.dot(samples.place[n], colour, 4)
        drawing.text(samples.place[n], name, 9, -6, "start", colour, 14, "italic")
    drawing.eye(eye)
    values = {name: (float(samples.flux[n]), bool(samples.seen[n])) for name, n in where.items()}
    return drawing.svg(), values


def seen_region(polygon, edges, eye):
    """Figure 4.14: a region and what is seen of it from afar."""
    samples = Samples(polygon, edges, eye, 0.4)
    drawing = Drawing(polygon.min(0) - 14, polygon.max(0) + [14, 60], 430)
    drawing.line(polygon, GREY, 1.4, closed=True, fill="#f4f5f6")
    drawing.line([polygon[edges[0]], *(polygon[(k + 1) % len(polygon)] for k in edges)], RED, 2.2)
    for first, last in samples.runs():
        drawing.line(samples.place[first:last + 1], BLUE, 4)
    top = numpy.array([0.5 * (polygon[:, 0].min() + polygon[:, 0].max()), polygon[:, 1].max() + 52])
    drawing.line([top, top - [0, 30]], INK, 2, arrow=True)
    drawing.text(top, "to P, far above", 8, 12, "start")
    return drawing.svg()


def flux_of_a_point():
    """Figure 4.12: ray, inward normal and the cosine between them."""
    t = numpy.linspace(0.16 * math.pi, 0.9 * math.pi, 90)
    curve = numpy.stack([90 * numpy.cos(t), 55 * numpy.sin(t)], 1)
    n = 36
    point, tangent = curve[n], curve[n + 1] - curve[n - 1]
    normal = numpy.array([-tangent[1], tangent[0]]) / numpy.linalg.norm(tangent)
    eye = numpy.array([78.0, 118.0])
    ray = (point - eye) / numpy.linalg.norm(point - eye)
    flux = float(ray @ normal)
    drawing = Drawing([-96, 4], [112, 130], 430)
    drawing.line(curve, BLUE, 2.6)
    drawing.line([eye, point], RED, 1.2, dash="5 3")
    drawing.line([point - 34 * ray, point], INK, 2, arrow=True)
    drawing.line([point, point + 34 * normal], INK, 2, arrow=True)
    drawing.line([point, point + 34 * ray], GREY, 1.2, dash="3 3")
    start, end = math.atan2(ray[1], ray[0]), math.atan2(normal[1], normal[0])
    arc = [point + 20 * numpy.array([math.cos(a), math.sin(a)]) for a in numpy.linspace(start, end, 20)]
    drawing.line(arc, GREEN, 1.6)
    drawing.text(point + 34 * normal, "N, inward", 8, 4, "start")
    drawing.text(point - 34 * ray, "unit ray", 10, 4, "start")
    drawing.text(arc[10], "θ", 4, 16, colour=GREEN, style="italic")
    drawing.text([-92, 112], f"flux = cos θ = {flux:.3f}", anchor="start", size=14)
    drawing.dot(point)
    drawing.eye(eye)
    return drawing.svg(), flux


def edge_and_rays(length, angle, eye):
    """Figure 4.16: an edge about the origin, its rays, and its flux by quadrature."""
    half = 0.5 * length * numpy.array([math.cos(angle), math.sin(angle)])
    a, b = half, -half  # counter-clockwise, its outer side up
    normal = inward_normal(a, b)
    x, w = numpy.polynomial.legendre.leggauss(40)
    points = 0.5 * (a + b) + 0.5 * x[:, None] * (b - a)
    total = 0.5 * length * sum(wk * flux_at(p, normal, eye) for wk, p in zip(w, points))
    drawing = Drawing([-44, -44], [44, eye[1] + 12], 300)
    for q in numpy.linspace(0, 1, 9):
        drawing.line([eye, a + q * (b - a)], PALE, 1)
    drawing.line([a, b], BLUE, 4)
    drawing.line([[0, 0], 18 * normal], INK, 1.6, arrow=True)
    drawing.text([0, -40], f"total flux {total:.2f} of length {length:g}", size=14)
    drawing.eye(eye)
    return drawing.svg(), total, (a, b)


# ---- space --------------------------------------------------------------------------------------

def over_picture(png, width, height, eye, targets, caption):
    """Figure 5.21: a picture of a surface with the viewpoint and its rays drawn over it."""
    data = base64.b64encode(png.read_bytes()).decode()
    rays = "".join(f'<path d="M{eye[0]},{eye[1]} L{x},{y}" stroke="{RED}" stroke-width="1.2" '
                   'stroke-dasharray="5 4" fill="none"/>' for x, y in targets)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height + 70}" width="{width}" '
            f'font-family="sans-serif"><rect width="100%" height="100%" fill="#fff"/>'
            f'<image href="data:image/png;base64,{data}" x="0" y="70" width="{width}" height="{height}"/>{rays}'
            f'<circle cx="{eye[0]}" cy="{eye[1]}" r="6" fill="{RED}"/><text x="{eye[0] + 12}" y="{eye[1] + 5}" '
            f'fill="{RED}" font-size="17" font-style="italic">P</text>'
            f'<text x="10" y="{height + 60}" font-size="14" fill="{INK}">{html.escape(caption)}</text></svg>')


def face_with_normal():
    """Figure 5.22: a face, the order of its corners and its inward unit normal (69)."""
    corners = numpy.array([[0, 0, 0], [52, 6, 4], [17, 40, 10]], float)
    eye = numpy.array([26.0, 20.0, 74.0])
    cross = numpy.cross(corners[1] - corners[0], corners[2] - corners[0])
    inward = -cross / numpy.linalg.norm(cross)
    flat = lambda p: numpy.array([p[0] + 0.35 * p[1], 0.42 * p[1] + 0.8 * p[2]])
    drawing = Drawing([-12, -38], [88, 78], 400)
    drawing.line([flat(c) for c in corners], BLUE, 2.4, closed=True, fill="#e3ecf7")
    centre = corners.mean(0)
    for name, c, dx, dy in zip("abc", corners, (-12, 14, 12), (8, 8, -6)):
        drawing.dot(flat(c), BLUE)
        drawing.line([flat(eye), flat(c)], PALE, 1)
        drawing.text(flat(c), "v" + name, dx, dy, style="italic", size=15)
    drawing.line([flat(centre), flat(centre + 28 * inward)], INK, 2, arrow=True)
    drawing.text(flat(centre + 28 * inward), "N, inward", 8, 12, "start")
    turn = [centre + 9 * (math.cos(a) * (corners[1] - corners[0]) / 52.5 + math.sin(a) *
                          numpy.cross(cross / numpy.linalg.norm(cross), (corners[1] - corners[0]) / 52.5))
            for a in numpy.linspace(-0.3, 4.2, 30)]
    drawing.line([flat(p) for p in turn], GREEN, 1.5, arrow=True)
    drawing.eye(flat(eye))
    return drawing.svg(), float((corners[0] - eye) @ inward)


# ---- the merging tree ---------------------------------------------------------------------------

class MergingTree:
    """The merging algorithm of section 5.4, step by step; nodes are numbered from 1 as in the figure."""

    def __init__(self, centroids, areas, neighbours):
        self.centre = {n + 1: numpy.atleast_1d(numpy.asarray(c, float)) for n, c in enumerate(centroids)}
        self.area = {n + 1: a for n, a in enumerate(areas)}
        self.children, self.parent = {}, {}
        near = {n + 1: {m + 1 for m in row} for n, row in enumerate(neighbours)}
        unmerged = sorted(near)
        while len(unmerged) > 1:
            near = self.merge_level(unmerged, near)
            unmerged = sorted(near)

    def merge_level(self, level, near):
        pairs = sorted((numpy.linalg.norm(self.centre[a] - self.centre[b]), a, b)
                       for a in level for b in near[a] if a < b)
        made = []
        for _, a, b in pairs:  # steps 3 and 4
            if a not in self.parent and b not in self.parent:
                made.append([a, b])
                self.parent[a] = self.parent[b] = -len(made)
        for _, a, b in pairs:  # steps 5 and 6
            for one, other in ((a, b), (b, a)):
                if one not in self.parent:
                    made[-self.parent[other] - 1].append(one)
                    self.parent[one] = self.parent[other]
        made.sort(key=min)
        for group in map(sorted, made):
            node = max(self.centre) + 1
            self.children[node] = group
            for child in group:
                self.parent[child] = node
            self.area[node] = sum(self.area[c] for c in group)
            self.centre[node] = sum(self.area[c] * self.centre[c] for c in group) / self.area[node]
        return {n: {self.parent[m] for c in self.children[n] for m in near[c]} - {n}
                for n in {self.parent[c] for c in level}}

    def starts(self, face, near):
        """Nodes at which the recursion for a face's forces begins, and the visited ones (figure 5.23b to d)."""
        visited = set()
        for n in (face, *near):
            while n is not None:
                visited.add(n)
                n = self.parent.get(n)
        def below(n):
            return {n}.union(*(below(c) for c in self.children.get(n, [])))
        found, left = [], set(self.centre) - visited
        while left:
            top = max(left)
            found.append(top)
            left -= below(top)
        return found, visited


def tree_of_the_figure():
    """Nine faces in a row, so spaced that the tree is the figure's."""
    at = [0, 1, 4, 5.2, 6.8, 10, 11.4, 15, 16.6]
    return MergingTree(at, [1] * 9, [[m for m in (n - 1, n + 1) if 0 <= m < 9] for n in range(9)])


def draw_tree(tree, title, face=None, near=()):
    starts, visited = tree.starts(face, near) if face else ([], set())
    height, place = {}, {}
    def lay(n):
        below = [lay(c) for c in tree.children.get(n, [])]
        height[n] = 1 + max((h for h, _ in below), default=-1)
        place[n] = numpy.mean([x for _, x in below]) if below else float(n)
        return height[n], place[n]
    root = max(tree.centre)
    lay(root)
    drawing = Drawing([0.2, -0.75], [9.8, 3.75], 460)
    spot = {n: (place[n], height[n]) for n in place}
    for child, parent in tree.parent.items():
        if parent in visited and face:
            continue
        drawing.line([spot[child], spot[parent]], GREY, 1.4)
    for n in place:
        x, y = drawing.at(spot[n])
        if face and n in visited and n > 9:
            continue  # a path to the root: deleted
        fill = GREY if n == face else "#f3c9a5" if n in near else "#cfe3cf" if n in starts else "#fff"
        drawing.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="14" fill="{fill}" stroke="{INK}"/>'
                             f'<text x="{x:.1f}" y="{y + 5:.1f}" text-anchor="middle" font-size="13">{n}</text>')
    drawing.text([0.4, -0.62], title, anchor="start", size=14)
    return drawing.svg(), starts


def length_of(polygon, edges):
    ends = numpy.roll(polygon, -1, axis=0)
    return sum(float(numpy.linalg.norm(ends[k] - polygon[k])) for k in edges)


def flow_states(states, edges, count=6):
    """A region on its way, at lengths that are evenly apart."""
    lengths = [length_of(p, edges) for p in states]
    wanted = numpy.linspace(lengths[0], lengths[-1], count)
    low = numpy.min([p.min(axis=0) for p in states], axis=0) - [4, 24]
    high = numpy.max([p.max(axis=0) for p in states], axis=0) + 4
    drawings = []
    for n in sorted({int(numpy.argmin(abs(numpy.array(lengths) - w))) for w in wanted}):
        drawing, p = Drawing(low, high, 240), states[n]
        drawing.line(p, GREY, 1, closed=True, fill="#f4f5f6")
        drawing.line([p[edges[0]], *(p[(k + 1) % len(p)] for k in edges)], BLUE, 2)
        drawing.text(low, f"iteration {n}, length {lengths[n]:.0f}", 8, -8, "start")
        drawings.append(drawing.svg())
    return drawings


# ---- annular tissue -----------------------------------------------------------------------------

def grid_cells(path):
    """Points (P, 3) and cells (C, 4 or 8) of a .vtu of `explica thickness --cells`."""
    content = path.read_bytes()
    head, _, raw = content.partition(b'<AppendedData encoding="raw">\n_')
    kinds = {"Int32": "<i4", "Float64": "<f8"}

    def array(name):
        kind, offset = re.search(rf'type="(\w+)" Name="{name}".*?offset="(\d+)"', head.decode()).groups()
        start = int(offset) + 8
        size = int.from_bytes(raw[start - 8 : start], "little")
        return numpy.frombuffer(raw[start : start + size], kinds[kind])

    offsets = array("offsets")
    return array("Points").reshape(-1, 3), array("connectivity").reshape(len(offsets), -1)


class Slice:
    """One slice of the volumes of `explica thickness`, in mm along its own axes."""

    def __init__(self, folder, k):
        images = {name: nibabel.load(folder / f"{name}.nii.gz") for name in
                  ("harmonic", "thickness", "inner_distance", "outer_distance", "inner_point", "outer_point")}
        self.affine = images["harmonic"].affine
        self.inverse = numpy.linalg.inv(self.affine)
        self.spacing = numpy.linalg.norm(self.affine[:3, :3], axis=0)
        self.k = k
        self.data = {name: numpy.asarray(image.dataobj, float).squeeze() for name, image in images.items()}
        if images["harmonic"].shape[2:] != (1,):
            self.data = {name: values[:, :, k] for name, values in self.data.items()}
        self.tissue = self.data["thickness"] > 0
        gradient = numpy.stack(numpy.gradient(self.data["harmonic"], *self.spacing[:2]), axis=-1)
        with numpy.errstate(invalid="ignore", divide="ignore"):
            self.tangent = gradient / numpy.linalg.norm(gradient, axis=-1, keepdims=True)

    def place(self, world):
        """RAS mm (..., 3) as mm in the slice (..., 2)."""
        return (world @ self.inverse[:3, :3].T + self.inverse[:3, 3])[..., :2] * self.spacing[:2]

    def along(self, at):
        """The unit tangent at a place: that of the nearest voxels, by distance."""
        low = numpy.floor(at / self.spacing[:2]).astype(int)
        share = at / self.spacing[:2] - low
        total = numpy.zeros(2)
        for i in (0, 1):
            for j in (0, 1):
                t = self.tangent[tuple(numpy.clip(low + (i, j), 0, numpy.array(self.tissue.shape) - 1))]
                if numpy.all(numpy.isfinite(t)):
                    total += (share[0] if i else 1 - share[0]) * (share[1] if j else 1 - share[1]) * t
        return total / max(numpy.linalg.norm(total), 1e-12)

    def path(self, voxel):
        """The trajectory through a voxel's centre, from one boundary's point to the other's."""
        step = 0.25 * self.spacing[:2].min()
        halves = []
        for sign, name in ((-1, "inner"), (1, "outer")):
            half = [voxel * self.spacing[:2]]
            for _ in range(int(self.data[f"{name}_distance"][tuple(voxel)] / step)):
                middle = half[-1] + 0.5 * sign * step * self.along(half[-1])
                half.append(half[-1] + sign * step * self.along(middle))
            halves.append([*half, self.place(self.data[f"{name}_point"][tuple(voxel)])])
        return [*halves[0][::-1], *halves[1][1:]]


def apart(voxels, spacing, least):
    """Those of the voxels that are `least` mm from those before."""
    chosen, places = [], numpy.empty((0, 2))
    for v in voxels:
        if numpy.all(((v * spacing - places) ** 2).sum(axis=1) >= least ** 2):
            chosen.append(v)
            places = numpy.vstack([places, v * spacing])
    return chosen


def annular_field(folder, cells=None):
    """The slice with most tissue, as SVGs: u, its tangent field, selected trajectories, and the grid's
    cells where a .vtu is given."""
    thickness = numpy.asarray(nibabel.load(folder / "thickness.nii.gz").dataobj)
    k = int(numpy.argmax((thickness.reshape(*thickness.shape[:2], -1) > 0).sum(axis=(0, 1))))
    cut = Slice(folder, k)
    h, u = cut.spacing[:2], cut.data["harmonic"]
    voxels = numpy.argwhere(cut.tissue)
    low, high = (voxels.min(axis=0) - 1.5) * h, (voxels.max(axis=0) + 1.5) * h
    ends = {name: cut.place(cut.data[f"{name}_point"][cut.tissue & (cut.data[f"{name}_distance"] < 1.2 * h.max())])
            for name in ("inner", "outer")}
    drawings = [Drawing(low, high, 330) for _ in range(4 if cells else 3)]
    for panel, drawing in enumerate(drawings):
        for v in voxels:
            band = (math.floor(min(u[tuple(v)], 0.999) * 10) + 0.5) / 10
            colour = "#%02x%02x%02x" % tuple(round(a + band * (b - a)) for a, b in ((250, 88), (226, 120), (190, 196)))
            corners = [(v + d) * h for d in ((-0.52, -0.52), (0.52, -0.52), (0.52, 0.52), (-0.52, 0.52))]
            drawing.line(corners, "none", 0, closed=True, fill=colour if panel == 0 else "#eef0f2")
        for name, colour in (("inner", "#b01414"), ("outer", "#143c9c")):
            for p in ends[name]:
                drawing.dot(p, colour, 1.1)
    longest = (high - low).max()
    for v in apart(voxels, h, longest / 34):
        half = 0.4 * longest / 34 * numpy.nan_to_num(cut.tangent[tuple(v)])
        if half.any():
            drawings[1].line([v * h - half, v * h + half], "#333", 0.9)
            drawings[1].dot(v * h + half, "#333", 1.4)
    for v in apart([v for v in voxels if abs(u[tuple(v)] - 0.5) < 0.15], h, longest / 16):
        path = cut.path(v)
        drawings[2].line(path, "#0f6b3a", 1.4)
        drawings[2].dot(path[0], "#b01414", 2.4)
        drawings[2].dot(path[-1], "#143c9c", 2.4)
    if cells:
        points, corners = grid_cells(cells)
        near = abs(points @ cut.inverse[2, :3] + cut.inverse[2, 3] - k) <= 0.5
        flat = cut.place(points)
        sides = {tuple(sorted((c[a], c[(a + 1) % 4]))) for c in corners[:, :4] for a in range(4)}
        for a, b in sorted(sides):
            if near[a] and near[b]:
                drawings[3].line([flat[a], flat[b]], "#333", 0.5)
    return [drawing.svg() for drawing in drawings]
