# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Tissue: classes of a T1, thickness between two boundaries, surfaces of the cortical ribbon."""

import functools

from . import _explica
from .images import as_array, like

_MAPS = {
    "harmonic", "thickness", "inner_distance", "outer_distance", "depth", "inner_point",
    "outer_point", "layers", "labels", "csf", "gm", "wm",
}  # fmt: skip


def _maps_like(image, result, affine):
    """The result's maps as what `image` was: nibabel images, or arrays."""
    return {
        name: like(image, value, affine) if name in _MAPS else value
        for name, value in result.items()
    }


@functools.wraps(_explica.thickness)
def thickness(labels, affine=None, **options):
    values, matrix = as_array(labels, affine)
    return _maps_like(labels, _explica.thickness(values, matrix, **options), matrix)


@functools.wraps(_explica.thickness_of_levels)
def thickness_of_levels(inner, outer, affine=None, **options):
    inside, matrix = as_array(inner, affine)
    outside, _ = as_array(outer, affine)
    return _maps_like(inner, _explica.thickness_of_levels(inside, outside, matrix, **options), matrix)


@functools.wraps(_explica.surfaces)
def surfaces_of(labels, affine=None, **options):
    return _explica.surfaces(*as_array(labels, affine), **options)


@functools.wraps(_explica.segment)
def segment(intensity, affine=None, **options):
    values, matrix = as_array(intensity, affine)
    return _maps_like(intensity, _explica.segment(values, matrix, **options), matrix)


for _function in (thickness, thickness_of_levels, surfaces_of, segment):
    _function.__doc__ = _function.__doc__.split("\n\n", 1)[-1]  # without pybind11's signature line
