# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
from typing import Any, Optional, Sequence, Tuple

from numpy.typing import ArrayLike, NDArray

from .types import Image, Path, Progress, Surface

def encode_gif(frames: Sequence[ArrayLike], frames_per_second: float = 10.0) -> bytes: ...
def page(folder: Path, progress: Optional[Progress] = None) -> str: ...
def picture(
    surface: Surface,
    values: Optional[ArrayLike] = None,
    views: Sequence[str] = ...,
    towards: Optional[ArrayLike] = None,
    up: ArrayLike = ...,
    focus: ArrayLike = ...,
    title: str = '',
    unit: str = '',
    range: Optional[Tuple[float, float]] = None,
    colours: Optional[str] = None,
    *,
    width: int = 1200,
    height: int = 900,
    samples: int = 2,
    occlusion: float = 0.9,
) -> NDArray[Any]: ...
def slices(
    image: Image,
    affine: Optional[ArrayLike] = None,
    surfaces: Sequence[Surface] = ...,
    count: int = 3,
    height: int = 300,
) -> NDArray[Any]: ...
def write_png(path: Path, pixels: ArrayLike) -> None: ...
