# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures as arrays of pixels, drawn without a display."""

from ._explica import report as _compiled
from ._images import of_image as _of_image
from ._surfaces import as_mesh as _as_mesh
from ._surfaces import of_mesh as _of_mesh

picture = _of_mesh(_compiled.picture, module=_compiled)
_slices = _of_image("image", module=_compiled)(_compiled.slices)


def slices(
    image: "Image",
    affine: "Optional[ArrayLike]" = None,
    surfaces: "Sequence[Surface]" = (),
    count: int = 3,
    height: int = 300,
) -> "NDArray[Any]":
    return _slices(image, affine, [_as_mesh(one) for one in surfaces], count, height)


slices.__doc__ = _slices.__doc__

__all__ = ["picture", "slices"]
