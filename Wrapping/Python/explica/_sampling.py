# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Values of images on the cortex: at depths between surfaces, and where points lie in it."""

import numpy as np

from . import _explica
from ._images import as_array, same_grid
from ._surfaces import as_mesh


def _pair(white, pial):
    """Positions of both surfaces and their common faces."""
    inner, faces = as_mesh(white)
    outer, others = as_mesh(pial)
    if faces.shape != others.shape or not np.array_equal(faces, others):
        raise _explica.InvalidInput("white and pial: their faces differ; surfaces of one run are needed")
    return inner, outer, faces


def sample(
    image: "Image",
    white: "Surface",
    pial: "Surface",
    depths: "ArrayLike" = (0.5,),
    affine: "Optional[ArrayLike]" = None,
    *,
    depth_kind: "str" = "depth",
    interpolate: "str" = "linear",
    mask: "Optional[Image]" = None,
    to_volume: "Optional[ArrayLike]" = None,
) -> "NDArray[np.float32]":
    """Values of an image at depths from 0 (white) to 1 (pial): (D, V), of a series (D, V, T).

    NaN where a value is not known: outside the field of view or `mask`, or where the image is NaN.
    `to_volume` is the 4 x 4 matrix from the surfaces to the image's world, RAS mm, if they differ.
    """
    values, matrix = as_array(image, affine)
    inner, outer, faces = _pair(white, pial)
    depths = np.atleast_1d(np.asarray(depths, dtype=float))
    points = np.concatenate(
        [_explica.positions_at_depth(inner, outer, faces, depth, depth_kind) for depth in depths]
    )
    if to_volume is not None:
        there = np.asarray(to_volume, dtype=float)
        points = points @ there[:3, :3].T + there[:3, 3]
    if mask is not None:
        mask = same_grid(mask, matrix, "mask")
    got = _explica.sample_points(values, matrix, points, interpolate, mask)
    got = got.reshape(len(got), len(depths), len(inner))
    return got[0] if values.ndim == 3 else np.moveaxis(got, 0, -1)


def positions_at_depth(
    white: "Surface", pial: "Surface", depth: "float", kind: "str" = "depth"
) -> "NDArray[np.float64]":
    """Vertices (V, 3) at a depth from 0 (white) to 1 (pial).

    `kind` is "depth", a share of the distance, or "volume", a share of the column's volume.
    """
    inner, outer, faces = _pair(white, pial)
    return _explica.positions_at_depth(inner, outer, faces, depth, kind)


def nearest_columns(white: "Surface", pial: "Surface", points: "ArrayLike") -> "Dict[str, Any]":
    """Where points (P, 3), RAS mm, lie in the cortex: vertex, depth and distance in mm of each."""
    inner, outer, faces = _pair(white, pial)
    return _explica.nearest_columns(inner, outer, faces, np.asarray(points, dtype=float))
