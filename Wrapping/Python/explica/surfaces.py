# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Surfaces: files, (positions, faces) and nibabel GIFTI images, all taken alike."""

import functools
import os

import numpy as np

from . import _explica
from ._explica import folded_sphere, icosphere, read_surface, read_vertex_maps, write_shape


def as_mesh(surface):
    """(positions, faces) of a path, a nibabel GIFTI image, or a pair of arrays."""
    if isinstance(surface, (str, os.PathLike)):
        return read_surface(os.fspath(surface))
    if hasattr(surface, "agg_data"):
        positions, faces = surface.agg_data(("pointset", "triangle"))
    else:
        positions, faces = surface
    return (
        np.ascontiguousarray(positions, dtype=np.float64),
        np.ascontiguousarray(faces, dtype=np.int32),
    )


def of_mesh(function):
    """Lets a compiled function of positions and faces take any surface as its first argument."""

    @functools.wraps(function)
    def call(surface, *arguments, **keywords):
        return function(*as_mesh(surface), *arguments, **keywords)

    call.__doc__ = function.__doc__.split("\n\n", 1)[-1]
    return call


closest_points = of_mesh(_explica.closest_points)
enclosed_volume = of_mesh(_explica.enclosed_volume)
face_areas = of_mesh(_explica.face_areas)
geodesic_distances = of_mesh(_explica.geodesic_distances)
inspect_mesh = of_mesh(_explica.inspect_mesh)
self_intersections = of_mesh(_explica.self_intersections)
vertex_areas = of_mesh(_explica.vertex_areas)
vertex_normals = of_mesh(_explica.vertex_normals)


def write_surface(path, surface, structure="Other", secondary=""):
    """Write a surface; the format follows the name, whole or not at all."""
    _explica.write_surface(os.fspath(path), *as_mesh(surface), structure, secondary)
