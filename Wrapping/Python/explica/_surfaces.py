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


def _of_meshes():
    """The compiled functions whose arguments begin with positions and faces, by name."""
    for name, function in vars(_explica).items():
        if callable(function) and f"{name}(positions: " in (function.__doc__ or ""):
            yield name, of_mesh(function)


globals().update(_of_meshes())
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
__all__ = ["Unfolder", "write_surface", *dict(_of_meshes())]
