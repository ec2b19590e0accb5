# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Section 4.1 of the thesis: its two global measures of how visible a closed polygon is from everywhere,
and the flows that descend on them.  Neither unfolds: that is what they show."""

import numpy
from numpy.linalg import norm

FAR = 10  # radius of the viewing circle over that of the farthest vertex
GONE = 1e-2  # share of the mean edge: a shorter one has shrunk to nothing
NOTHING_LEFT = 1e-6  # share of the start's measure
STEP = 0.04  # of the fastest vertex, in mean edges
DIFFERENCE = 1e-5  # of a coordinate, in mean edges: its square is far below a length, far above round-off


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def edge_lengths(p):
    return norm(numpy.roll(p, -1, 0) - p, axis=1)


def with_gradient(p, at, measure):
    """Sum of a measure of elements, at[e] the vertices of each, and its gradient by central differences."""
    corners, h = at.shape[1], DIFFERENCE * edge_lengths(p).mean()
    steps = h * numpy.eye(2 * corners).reshape(-1, 1, corners, 2)
    ends = p[at]
    slopes = (measure(ends + steps) - measure(ends - steps)) / (2 * h)
    gradient = numpy.zeros_like(p)
    numpy.add.at(gradient, at, slopes.T.reshape(len(at), corners, 2))
    return measure(ends).sum(), gradient


def hidden_arc(p, centre, radius):
    """(4.6) of a closed polygon (V, 2), counter-clockwise: r sum L (2 pi - 2 acos(h / r)), h the distance of
    an edge's line from the centre."""
    def of_edges(ends):
        a, b = ends[..., 0, :] - centre, ends[..., 1, :] - centre
        length = norm(b - a, axis=-1)
        return radius * length * (2 * numpy.pi - 2 * numpy.arccos(cross(a, b) / length / radius))

    i = numpy.arange(len(p))
    return with_gradient(p, numpy.stack([i, (i + 1) % len(p)], 1), of_edges)


def occlusion(p):
    """(4.7) of a closed polygon: the measure of the pairs of points that hide each other."""
    i, j = numpy.triu_indices(len(p), 1)
    at = numpy.stack([i, (i + 1) % len(p), j, (j + 1) % len(p)], 1)

    def of_pairs(ends):
        value = 2
        for k, other in ((0, 2), (2, 0)):
            way = ends[..., k + 1, :] - ends[..., k, :]
            length, heights = norm(way, axis=-1), []
            for end in (other, other + 1):  # distance outward of the edge's line; 0 for a common vertex
                height = -cross(way, ends[..., end, :] - ends[..., k, :]) / length
                heights.append(numpy.where((at[:, k] == at[:, end]) | (at[:, k + 1] == at[:, end]), 0, height))
            before, extent = sum(numpy.maximum(heights, 0)), sum(numpy.abs(heights))
            value = value * length * numpy.divide(before, extent, out=numpy.zeros_like(extent), where=extent > 0)
        return value

    return with_gradient(p, at, of_pairs)


def polygon_flow(p, measure, most):
    """States of a polygon by the flow of "arc" (4.6) or "occlusion" (4.7), the start first: steps along
    -gradient that shrink to nothing."""
    centre = p.mean(axis=0)
    radius = FAR * norm(p - centre, axis=1).max()
    value_of = (lambda q: hidden_arc(q, centre, radius)) if measure == "arc" else occlusion
    value, gradient = value_of(p)
    states, start, mean_edge = [p], value, edge_lengths(p).mean()
    for n in range(most):
        steepest = norm(gradient, axis=1).max()
        if not steepest > 0 or value <= NOTHING_LEFT * start or edge_lengths(p).min() < GONE * mean_edge:
            break
        p = p - STEP * mean_edge * (1 - n / most) / steepest * gradient
        value, gradient = value_of(p)
        states.append(p)
    return states
