# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Images: numpy arrays with an affine and nibabel images, taken alike."""

import functools
import inspect

import numpy as np

from . import _explica
from ._signature import prose, signature_of


def is_image(image):
    """True for nibabel's images and what behaves like them."""
    return hasattr(image, "dataobj") and hasattr(image, "affine")


def as_array(image, affine=None):
    """(array, affine) of a nibabel image, or of an array that comes with its affine.

    An array without an affine is taken to have voxels of 1 mm along R, A and S.
    """
    if is_image(image):
        if affine is not None:
            raise _explica.UsageError("affine: an image has its own; pass one or the other")
        return np.asanyarray(image.dataobj), np.asarray(image.affine, dtype=float)
    values = np.asanyarray(image)
    return values, np.eye(4) if affine is None else np.asarray(affine, dtype=float)


def like(image, values, affine):
    """`values` as what `image` was: a nibabel image, or the array itself."""
    if is_image(image):
        import nibabel

        return nibabel.Nifti1Image(values, affine)
    return values


def same_grid(image, affine, name):
    """The array of a further image on the grid of the first."""
    values, own = as_array(image, None if is_image(image) else affine)
    if not np.allclose(own, affine, rtol=0, atol=1e-4):
        raise _explica.InvalidInput(f"{name}: lies on another grid; resample it to the first image's")
    return values


def of_image(*images, module=_explica):
    """Lets a compiled function of arrays and an affine take images as the arguments named.

    The affine becomes optional, and results that are maps on the first image's grid are images if
    it was one.
    """

    def wrap(function):
        compiled = signature_of(function.__doc__, module.keywords.get(function.__name__, []))
        parameters = dict(compiled.parameters)
        affine = parameters.pop("affine").replace(annotation="Optional[ArrayLike]", default=None)
        for name in images:
            optional = parameters[name].default is None
            parameters[name] = parameters[name].replace(
                annotation="Optional[Image]" if optional else "Image"
            )
        ordered = list(parameters.values())
        first_optional = [p.default is p.empty for p in ordered].count(True)
        ordered.insert(first_optional, affine)
        positional = [p.name for p in ordered if p.kind is p.POSITIONAL_OR_KEYWORD]

        @functools.wraps(function)
        def call(*arguments, **keywords):
            if len(arguments) > len(positional):
                raise TypeError(f"{function.__name__}() takes at most {len(positional)} arguments")
            keywords.update(zip(positional, arguments))
            first = keywords[images[0]] if images[0] in keywords else None
            if first is None:
                raise TypeError(f"{function.__name__}() needs '{images[0]}'")
            values, matrix = as_array(first, keywords.pop("affine", None))
            keywords[images[0]] = values
            for name in images[1:]:
                if keywords.get(name) is not None:
                    keywords[name] = same_grid(keywords[name], matrix, name)
            result = function(affine=matrix, **keywords)
            if not isinstance(result, dict):
                return result
            grid = (values.shape + (1,))[:3]
            return {
                name: like(first, value, matrix)
                if isinstance(value, np.ndarray) and value.shape[:3] == grid
                else value
                for name, value in result.items()
            }

        call.__doc__ = prose(function.__doc__)
        call.__module__ = "explica"
        call.__signature__ = inspect.Signature(
            ordered, return_annotation=compiled.return_annotation
        )
        return call

    return wrap


thickness = of_image("labels")(_explica.thickness)
thickness_of_levels = of_image("inner", "outer")(_explica.thickness_of_levels)
anatomical_grid = of_image("labels")(_explica.anatomical_grid)
surfaces_of = of_image("labels", "image")(_explica.surfaces_of)


def write_volume(path: "Path", image: "Image", affine: "Optional[ArrayLike]" = None) -> None:
    """Write an image or array; the format follows the name, whole or not at all."""
    values, matrix = as_array(image, affine)
    if values.dtype.kind in "bu":
        values = values.astype(np.int32)
    _explica.write_volume(path, values, matrix)

