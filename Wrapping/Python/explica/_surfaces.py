# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Surfaces: files, (positions, faces) and nibabel GIFTI images, taken alike."""

import functools
import os

import numpy as np

from . import _explica
from ._signature import prose, replace_first, signature_of


def as_mesh(surface):
    """(positions, faces) of a path, a nibabel GIFTI image, or a pair of arrays."""
    if isinstance(surface, (str, os.PathLike)):
        return _explica.read_surface(surface)
    if hasattr(surface, "agg_data"):
        positions, faces = surface.agg_data(("pointset", "triangle"))
    else:
        positions, faces = surface
    return (
        np.ascontiguousarray(positions, dtype=np.float64),
        np.ascontiguousarray(faces, dtype=np.int32),
    )


def of_mesh(function, module=_explica, place=0):
    """Lets a compiled function of positions and faces take any surface as argument `place`."""

    @functools.wraps(function)
    def call(*arguments, **keywords):
        arguments = list(arguments)
        if len(arguments) > place:
            arguments[place : place + 1] = as_mesh(arguments[place])
        elif "surface" in keywords:
            keywords["positions"], keywords["faces"] = as_mesh(keywords.pop("surface"))
        return function(*arguments, **keywords)

    signature = signature_of(function.__doc__, module.keywords.get(function.__name__, []))
    call.__signature__ = replace_first(signature, place, 2, "surface", "Surface")
    call.__doc__ = prose(function.__doc__)
    call.__module__ = "explica"
    return call


average_visibility = of_mesh(_explica.average_visibility)
backfacing_share = of_mesh(_explica.backfacing_share)
distance_errors = of_mesh(_explica.distance_errors)
distortion = of_mesh(_explica.distortion)
enclosed_volume = of_mesh(_explica.enclosed_volume)
face_areas = of_mesh(_explica.face_areas)
face_normals = of_mesh(_explica.face_normals)
flat_grid = of_mesh(_explica.flat_grid)
flatten = of_mesh(_explica.flatten)
geodesic_distances = of_mesh(_explica.geodesic_distances)
inspect_mesh = of_mesh(_explica.inspect_mesh)
mean_curvature = of_mesh(_explica.mean_curvature)
sulcal_depth = of_mesh(_explica.sulcal_depth)
relief_cuts = of_mesh(_explica.relief_cuts)
repair_surface = of_mesh(_explica.repair_surface)
select_region = of_mesh(_explica.select_region)
self_intersections = of_mesh(_explica.self_intersections)
unfold = of_mesh(_explica.unfold)
vertex_areas = of_mesh(_explica.vertex_areas)
vertex_flux = of_mesh(_explica.vertex_flux)
vertex_normals = of_mesh(_explica.vertex_normals)
visible_fraction = of_mesh(_explica.visible_fraction)
write_surface = of_mesh(_explica.write_surface, place=1)


def _class_of_mesh(base):
    """Lets a compiled class whose constructor begins with positions and faces take any surface."""

    def construct(self, *arguments, **keywords):
        arguments = list(arguments)
        if arguments:
            arguments[0:1] = as_mesh(arguments[0])
        else:
            keywords["positions"], keywords["faces"] = as_mesh(keywords.pop("surface"))
        base.__init__(self, *arguments, **keywords)

    signature = signature_of(base.__init__.__doc__, _explica.keywords.get(base.__name__, []))
    construct.__signature__ = replace_first(signature, 1, 2, "surface", "Surface")
    return type(
        base.__name__, (base,),
        {"__init__": construct, "__doc__": base.__doc__, "__module__": "explica"},
    )  # fmt: skip


Unfolder = _class_of_mesh(_explica.Unfolder)
