# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
from typing import Any, Dict, List, Literal, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .types import Image, Path, Progress

def circle(edges: int, radius: float = 1.0, centre: ArrayLike = ...) -> NDArray[np.float64]: ...
def contours_of_label(
    labels: Image,
    label: int,
    affine: Optional[ArrayLike] = None,
    slice: Optional[int] = None,
    smoothing: float = 0.6,
) -> Tuple[List[NDArray[np.float64]], Dict[str, Any]]: ...
def contours_of_level(
    field: Image,
    level: float,
    affine: Optional[ArrayLike] = None,
    slice: int = 0,
) -> Tuple[List[NDArray[np.float64]], Dict[str, Any]]: ...
def edge_lengths(polygon: ArrayLike, closed: bool = True) -> NDArray[np.float64]: ...
def ellipse(edges: int, a: float, b: float) -> NDArray[np.float64]: ...
def hidden_viewing_arc(polygon: ArrayLike, centre: ArrayLike, radius: float) -> float: ...
def knot_energy(
    polygon: ArrayLike,
    moves: Optional[ArrayLike] = None,
    method: str = 'all-pairs',
    opening_ratio: float = 0.25,
) -> Tuple[float, NDArray[np.float64]]: ...
def largest_safe_step(polygon: ArrayLike, target: ArrayLike) -> float: ...
def polygon19() -> Dict[str, Any]: ...
def polygon34() -> Dict[str, Any]: ...
def read_polygon(path: Path) -> NDArray[np.float64]: ...
def resample(polygon: ArrayLike, edges: int) -> NDArray[np.float64]: ...
def self_intersections(polygon: ArrayLike, closed: bool = True) -> NDArray[np.int32]: ...
def self_occlusion(polygon: ArrayLike) -> float: ...
def signed_area(polygon: ArrayLike) -> float: ...
def unfold(
    polygon: ArrayLike,
    region: Optional[Tuple[int, int]],
    viewpoint: ArrayLike,
    progress: Optional[Progress] = None,
    *,
    method: Literal["implicit", "thesis"] = 'implicit',
    surround: Literal["fixed", "elastic", "none"] = 'fixed',
    collar: int = 4,
    no_length: bool = False,
    no_topology: bool = False,
    knot: Literal["tree", "all-pairs", "off"] = 'all-pairs',
    knot_weight: float = 0.02,
    target_visibility: float = 0.995,
    max_iterations: int = 20000,
    max_time: float = 600.0,
    visibility_gain: float = 1000.0,
    repulsion_gain: float = 0.02,
    explicit_step: float = 0.01,
) -> Dict[str, Any]: ...
def visibility(
    polygon: ArrayLike,
    viewpoint: ArrayLike,
    region: Optional[Tuple[int, int]] = None,
) -> Dict[str, Any]: ...
def visible_part(
    polygon: ArrayLike,
    viewpoint: ArrayLike,
    region: Optional[Tuple[int, int]] = None,
) -> Dict[str, Any]: ...
def write_polygon(path: Path, polygon: ArrayLike) -> None: ...
