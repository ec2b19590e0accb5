# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
from typing import Any, Dict, Iterable, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .types import Progress, Target

def around(
    targets: Sequence[Target],
    *,
    centre: Optional[ArrayLike] = None,
    inner_radius: Optional[float] = None,
    outer_radius: Optional[float] = None,
    order: Optional[int] = None,
    samples: int = 2000,
) -> Shape: ...
def average(shapes: Iterable[Shape]) -> Shape: ...
def band(targets: Sequence[ArrayLike], width: float, order: Optional[int] = None) -> Shape: ...
def between(
    inner_boundary: ArrayLike,
    outer_boundary: ArrayLike,
    order: Optional[int] = None,
) -> Shape: ...
def combine(shapes: Sequence[Shape], weights: ArrayLike) -> Shape: ...
def concentric(
    dimension: int,
    centre: ArrayLike,
    inner_radius: float,
    outer_radius: float,
    order: int,
) -> Shape: ...
def distance(shape: Target, target: Target) -> Tuple[float, float]: ...
def fit(
    target: Target,
    start: Optional[Shape] = None,
    progress: Optional[Progress] = None,
    *,
    samples: int = 2000,
    max_iterations: int = 200,
    fit_step: float = 0.5,
    smoothness: float = 1e-09,
) -> Dict[str, Any]: ...
class Shape:
    def __init__(
        self,
        dimension: int,
        centre: ArrayLike,
        inner_radius: float,
        outer_radius: float,
        inner: ArrayLike,
        outer: ArrayLike,
        order: int,
    ) -> None: ...
    @property
    def dimension(self) -> int: ...
    @property
    def centre(self) -> NDArray[np.float64]: ...
    @property
    def inner_radius(self) -> float: ...
    @property
    def outer_radius(self) -> float: ...
    @property
    def order(self) -> int: ...
    @property
    def inner(self) -> NDArray[np.float64]: ...
    @property
    def outer(self) -> NDArray[np.float64]: ...
    @property
    def inner_boundary(self) -> Optional[NDArray[np.float64]]: ...
    @property
    def outer_boundary(self) -> Optional[NDArray[np.float64]]: ...
    def with_coefficients(self, inner: ArrayLike, outer: ArrayLike) -> Shape: ...
    @property
    def margin(self) -> float: ...
    def values(self, points: ArrayLike) -> NDArray[np.float64]: ...
    def surface(self, voxels: int = 96) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
    def polygon(self, voxels: int = 96) -> NDArray[np.float64]: ...
    def field(self, voxels: int = 96) -> Tuple[NDArray[Any], NDArray[np.float64]]: ...
