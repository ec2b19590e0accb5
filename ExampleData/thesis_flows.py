# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Section 4.1 of the thesis: its two global measures of how visible a shape is from everywhere, with
their gradients, and the flows that descend on them.  Neither unfolds: that is what they show."""

import numpy

FAR = 10  # radius of the viewing circle or sphere over that of the farthest vertex
GONE = 1e-2  # share of the mean edge: a shorter one has shrunk to nothing
NOTHING_LEFT = 1e-6  # share of the start's measure


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def hidden_arc(p, centre, radius):
    """(4.6) of a closed polygon (V, 2), counter-clockwise, and its gradient: r sum L (2 pi - 2 acos(h / r)),
    h the distance of an edge's line from the centre."""
    a, b = p - centre, numpy.roll(p, -1, 0) - centre
    length = numpy.linalg.norm(b - a, axis=1)
    tangent, h = (b - a) / length[:, None], cross(a, b) / length
    arc = 2 * numpy.pi - 2 * numpy.arccos(h / radius)
    turn = 2 / numpy.sqrt(radius ** 2 - h ** 2)
    by_end = (arc - turn * h)[:, None] * tangent
    at_start = radius * (turn[:, None] * numpy.stack([b[:, 1], -b[:, 0]], 1) - by_end)
    at_end = radius * (turn[:, None] * numpy.stack([-a[:, 1], a[:, 0]], 1) + by_end)
    return radius * numpy.sum(length * arc), at_start + numpy.roll(at_end, 1, 0)


def positive_share(p, q, by_p, by_q):
    """Share of an edge on which a linear function with these values at its ends is positive."""
    share = numpy.where((p >= 0) & (q >= 0), 1.0, 0.0)
    share[(p <= 0) & (q <= 0)] = 0
    mixed = p * q < 0
    share[mixed] = numpy.maximum(p, q)[mixed] / abs(q - p)[mixed]
    slope = numpy.zeros_like(by_p)
    sign = numpy.where(p > 0, -1.0, 1.0) / numpy.where(mixed, (q - p) ** 2, 1)
    slope[mixed] = ((q * sign)[:, None, None] * by_p - (p * sign)[:, None, None] * by_q)[mixed]
    return share, slope


def occlusion_of_polygon(p):
    """(4.7) of a closed polygon and its gradient: the measure of the pairs of points that hide each other."""
    n = len(p)
    i, j = numpy.triu_indices(n, 1)
    at = numpy.stack([i, (i + 1) % n, j, (j + 1) % n], 1)
    ends, pairs = p[at], numpy.arange(len(i))

    def length_between(k):
        way = ends[:, k + 1] - ends[:, k]
        value, by = numpy.linalg.norm(way, axis=1), numpy.zeros((len(i), 4, 2))
        by[:, k + 1] = way / value[:, None]
        by[:, k] = -by[:, k + 1]
        return value, by

    def outward(k, length, by_length, end):
        """Distance of an end from an edge's line; one that both edges have lies on it."""
        t, d = ends[:, k + 1] - ends[:, k], ends[:, end] - ends[:, k]
        value, by = -cross(t, d) / length, numpy.zeros((len(i), 4, 2))
        by[:, end] += numpy.stack([t[:, 1], -t[:, 0]], 1)
        by[:, k + 1] += numpy.stack([-d[:, 1], d[:, 0]], 1)
        by[:, k] += numpy.stack([d[:, 1] - t[:, 1], t[:, 0] - d[:, 0]], 1)
        by = (by - value[:, None, None] * by_length) / length[:, None, None]
        common = (at[:, end] == at[:, k]) | (at[:, end] == at[:, k + 1])
        value[common], by[common] = 0, 0
        return value, by

    li, by_li = length_between(0)
    lj, by_lj = length_between(2)
    parts = [(li, by_li), (lj, by_lj)]
    for k, length, by_length, (first, last) in ((0, li, by_li, (2, 3)), (2, lj, by_lj, (0, 1))):
        (a, by_a), (b, by_b) = outward(k, length, by_length, first), outward(k, length, by_length, last)
        parts.append(positive_share(a, b, by_a, by_b))
    value, by = numpy.ones(len(pairs)), numpy.zeros((len(i), 4, 2))
    for part, by_part in parts:
        value, by = value * part, part[:, None, None] * by + value[:, None, None] * by_part
    gradient = numpy.zeros_like(p)
    numpy.add.at(gradient, at, 2 * by)
    return 2 * value.sum(), gradient


class Faces:
    """Areas, unit normals and centres of a surface's faces."""

    def __init__(self, v, f):
        self.v, self.f = v, f
        a, b, c = v[f[:, 0]], v[f[:, 1]], v[f[:, 2]]
        vector = 0.5 * numpy.cross(b - a, c - a)
        self.area = numpy.linalg.norm(vector, axis=1)
        self.normal = vector / self.area[:, None]
        self.centre = (a + b + c) / 3
        self.volume = numpy.sum(a * numpy.cross(b, c)) / 6
        edges = numpy.linalg.norm(v[f] - v[numpy.roll(f, -1, 1)], axis=2)
        self.least_edge, self.mean_edge = edges.min(), edges.mean()

    def to_corners(self, by_area, by_centre):
        """Derivatives by faces' area vectors and centres, as derivatives by the vertices."""
        gradient = numpy.zeros_like(self.v)
        for c in range(3):
            way = self.v[self.f[:, (c + 1) % 3]] - self.v[self.f[:, (c + 2) % 3]]
            numpy.add.at(gradient, self.f[:, c], 0.5 * numpy.cross(way, by_area) + by_centre / 3)
        return gradient

    def pairs_that_hide(self):
        """Faces i and j of which each lies before the other's plane, on the side it turns to."""
        own = numpy.sum(self.normal * self.centre, axis=1)
        other = self.normal @ self.centre.T
        before = other - own[:, None] > 0  # j before i's plane
        facing = own[None, :] - other.T < 0  # i before j's
        return numpy.nonzero(before & facing)


def hidden_area(faces, radius):
    """(4.6) of a closed surface: 2 pi r^2 A + 6 pi r V."""
    by_area, by_volume = 2 * numpy.pi * radius ** 2, 6 * numpy.pi * radius
    gradient = faces.to_corners(by_area * faces.normal, numpy.zeros_like(faces.centre))
    for c in range(3):
        after, last = (faces.v[faces.f[:, (c + k) % 3]] for k in (1, 2))
        numpy.add.at(gradient, faces.f[:, c], by_volume / 6 * numpy.cross(after, last))
    return by_area * faces.area.sum() + by_volume * faces.volume, gradient


def occlusion_of_surface(v, f):
    """(4.7): area of the pairs of faces that hide each other, mm^4."""
    faces = Faces(v, f)
    i, j = faces.pairs_that_hide()
    return float(numpy.sum(faces.area[i] * faces.area[j]))


def soft_occlusion(faces, softness=0.2):
    """(4.7) with steps that rise over cosines from 0 to `softness`, so that it has a gradient."""
    def soft(cosine):
        t = numpy.clip(cosine / softness, 0, 1)
        return t * t * (3 - 2 * t), 6 * t * (1 - t) / softness

    i, j = faces.pairs_that_hide()
    d = faces.centre[j] - faces.centre[i]
    length = numpy.linalg.norm(d, axis=1)
    u, ni, nj = d / length[:, None], faces.normal[i], faces.normal[j]
    ci, cj = numpy.sum(ni * u, axis=1), numpy.sum(nj * u, axis=1)
    (mine, my_slope), (theirs, their_slope) = soft(ci), soft(-cj)
    areas = faces.area[i] * faces.area[j]
    by_ci, by_cj = areas * my_slope * theirs, -areas * mine * their_slope
    both = mine * theirs
    by_area, by_centre = numpy.zeros_like(faces.centre), numpy.zeros_like(faces.centre)
    numpy.add.at(by_area, i, (faces.area[j] * both)[:, None] * ni
                 + (by_ci / faces.area[i])[:, None] * (u - ci[:, None] * ni))
    numpy.add.at(by_area, j, (faces.area[i] * both)[:, None] * nj
                 + (by_cj / faces.area[j])[:, None] * (u - cj[:, None] * nj))
    by_u = by_ci[:, None] * ni + by_cj[:, None] * nj
    by_d = (by_u - numpy.sum(by_u * u, axis=1)[:, None] * u) / length[:, None]
    numpy.add.at(by_centre, j, by_d)
    numpy.add.at(by_centre, i, -by_d)
    return numpy.sum(areas * both), faces.to_corners(by_area, by_centre)


def descend(p, value_of, edges_of, most, step):
    """Explicit steps along -gradient that shrink to nothing: the states, the start first."""
    value, gradient = value_of(p)
    states, start, mean_edge = [p], value, edges_of(p)[1]
    for n in range(most):
        steepest = numpy.linalg.norm(gradient, axis=1).max()
        if not steepest > 0 or value <= NOTHING_LEFT * start:
            break
        p = p - step * mean_edge * (1 - n / most) / steepest * gradient
        value, gradient = value_of(p)
        states.append(p)
        if edges_of(p)[0] < GONE * mean_edge:
            break
    return states


def polygon_flow(p, measure, most):
    """States of a polygon by the flow of "arc" (4.6) or "occlusion" (4.7)."""
    centre = p.mean(axis=0)
    radius = FAR * numpy.linalg.norm(p - centre, axis=1).max()
    def edges(q):
        lengths = numpy.linalg.norm(numpy.roll(q, -1, 0) - q, axis=1)
        return lengths.min(), lengths.mean()
    value = (lambda q: hidden_arc(q, centre, radius)) if measure == "arc" else occlusion_of_polygon
    return descend(p, value, edges, most, 0.04)


def surface_flow(v, f, measure, most):
    """The surface at the end of the flow of "area" (4.6) or "occlusion" (4.7), by each vertex's area."""
    centre = v.mean(axis=0)
    radius = FAR * numpy.linalg.norm(v - centre, axis=1).max()
    def value(q):
        faces = Faces(q - centre, f)
        measured, gradient = hidden_area(faces, radius) if measure == "area" else soft_occlusion(faces)
        shares = numpy.zeros(len(q))
        for c in range(3):
            numpy.add.at(shares, f[:, c], faces.area / 3)
        return measured, gradient / shares[:, None]
    def edges(q):
        faces = Faces(q, f)
        return faces.least_edge, faces.mean_edge
    return descend(v, value, edges, most, 0.1)[-1]
