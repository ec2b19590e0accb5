# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Images: files, numpy arrays with an affine, and nibabel images, all taken alike."""

import os

import numpy as np

from . import _explica
from ._explica import read_labels, read_scalars


def as_array(image, affine=None):
    """(array, affine) of a nibabel image, or of an array that comes with its affine.

    An array without an affine is taken to have voxels of 1 mm along R, A and S.
    """
    if hasattr(image, "dataobj") and hasattr(image, "affine"):
        if affine is not None:
            raise _explica.UsageError("affine: an image has its own; pass one or the other")
        return np.asanyarray(image.dataobj), np.asarray(image.affine, dtype=float)
    values = np.asanyarray(image)
    return values, np.eye(4) if affine is None else np.asarray(affine, dtype=float)


def like(image, values, affine):
    """`values` as what `image` was: a nibabel image of its class, or the array itself."""
    if hasattr(image, "dataobj") and hasattr(image, "affine"):
        import nibabel

        return nibabel.Nifti1Image(values, affine)
    return values


def write_volume(path, image, affine=None):
    """Write an image or array; the format follows the name, whole or not at all."""
    values, matrix = as_array(image, affine)
    if values.dtype.kind in "bu":
        values = values.astype(np.int32)
    _explica.write_volume(os.fspath(path), values, matrix)


__all__ = ["as_array", "like", "read_labels", "read_scalars", "write_volume"]
