# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What functions take, for type annotations."""

import os
from typing import Any, Callable, Optional, Protocol, Tuple, Union

from numpy.typing import ArrayLike

Path = Union[str, "os.PathLike[str]"]

# Called with the share of the work done, in [0, 1], and what is being done; False stops the work.
Progress = Callable[[float, str], Optional[bool]]


class SpatialImage(Protocol):
    """An image of nibabel: array I x J x K and affine 4 x 4 from index to RAS mm."""

    @property
    def dataobj(self) -> Any: ...

    @property
    def affine(self) -> Any: ...


class SurfaceImage(Protocol):
    """A GIFTI surface of nibabel."""

    def agg_data(self, intent_code: Any = ...) -> Any: ...


Image = Union[ArrayLike, SpatialImage]
Surface = Union[Path, SurfaceImage, Tuple[ArrayLike, ArrayLike]]
Target = Union[Surface, ArrayLike]
