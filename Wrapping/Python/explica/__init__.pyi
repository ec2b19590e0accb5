# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
from typing import Any, Dict, Literal, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import phantoms as phantoms
from . import planar as planar
from . import provenance as provenance
from . import report as report
from . import shapes as shapes
from . import study as study
from . import types as types
from .types import Image, Path, Progress, Surface

__version__: str

def anatomical_grid(
    labels: Image,
    levels: int,
    affine: Optional[ArrayLike] = None,
    recover_sulci: bool = True,
    progress: Optional[Progress] = None,
    *,
    inner: Sequence[int] = ...,
    tissue: Sequence[int] = ...,
    outer: Sequence[int] = ...,
    insulated: Sequence[int] = ...,
    boundary: Literal["subvoxel", "staircase", "embedding"] = 'subvoxel',
    open_ends: bool = False,
    per_slice: bool = False,
    facing: float = 100.0,
    method: Literal["hybrid", "eulerian", "lagrangian"] = 'hybrid',
    lambda_: Optional[float] = None,
    layers: int = 3,
    layer_kind: Literal["depth", "volume"] = 'depth',
) -> Dict[str, Any]: ...
def average_visibility(
    surface: Surface,
    viewpoints: Union[Viewpoints, ArrayLike],
    region: Optional[ArrayLike] = None,
) -> Dict[str, Any]: ...
def backfacing_share(
    surface: Surface,
    region: ArrayLike,
    viewpoints: Union[Viewpoints, ArrayLike],
) -> float: ...
def closest_points(
    surface: Surface,
    queries: ArrayLike,
) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def command(
    name: str,
    *inputs: Path,
    out: Optional[Path] = None,
    **options: Any,
) -> Dict[str, Any]: ...
def contact_barrier(distance: float, range: float) -> Tuple[float, float, float]: ...
def correct_topology(
    mask: Image,
    affine: Optional[ArrayLike] = None,
    genus: str = 'zero',
    progress: Optional[Progress] = None,
) -> Dict[str, Any]: ...
def cotangent_laplacian(
    surface: Surface,
) -> Tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]: ...
def distortion(surface: Surface, deformed: ArrayLike, region: ArrayLike) -> Dict[str, Any]: ...
def enclosed_volume(surface: Surface) -> float: ...
class Error(RuntimeError): ...
def executable() -> str: ...
def extract_faces(
    surface: Surface,
    wanted: ArrayLike,
) -> Tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]: ...
def face_areas(surface: Surface) -> NDArray[np.float64]: ...
def face_components(surface: Surface) -> NDArray[np.int32]: ...
def face_normals(surface: Surface) -> NDArray[np.float64]: ...
class FileError(OSError): ...
def folded_sphere(
    levels: int,
    radius: float = 1.0,
    depth: float = 0.25,
    waves: int = 6,
) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def geodesic_distances(
    surface: Surface,
    sources: ArrayLike,
    limit: float = ...,
) -> NDArray[np.float64]: ...
def hidden_viewing_area(surface: Surface, centre: ArrayLike, radius: float) -> float: ...
def icosphere(
    levels: int,
    radius: float = 1.0,
) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def inspect_mesh(surface: Surface) -> Dict[str, Any]: ...
class InvalidInput(ValueError): ...
def iso_surface(
    level: Image,
    affine: Optional[ArrayLike] = None,
) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def knot_energy(
    surface: Surface,
    moves: Optional[ArrayLike] = None,
    method: str = 'tree',
) -> Tuple[float, NDArray[np.float64]]: ...
class KnotEnergy:
    def __init__(
        self,
        surface: Surface,
        moves: Optional[ArrayLike] = None,
        method: str = 'tree',
    ) -> None: ...
    def evaluate(self, positions: ArrayLike) -> Tuple[float, NDArray[np.float64]]: ...
def largest_safe_step(
    surface: Surface,
    motion: ArrayLike,
    moves: Optional[ArrayLike] = None,
) -> float: ...
class MachineError(OSError): ...
def mean_curvature(surface: Surface, smoothing: int = 3) -> NDArray[np.float64]: ...
def mean_edge_length(surface: Surface) -> float: ...
def mesh_edges(surface: Surface) -> Tuple[NDArray[np.int32], NDArray[np.int32]]: ...
def near_pairs(
    surface: Surface,
    reach: float,
    moves: Optional[ArrayLike] = None,
) -> Tuple[NDArray[np.int32], NDArray[np.int32]]: ...
def read_labels(
    path: Path,
    *,
    xform: Literal["agreed", "qform", "sform", "none"] = 'agreed',
    frame: Optional[int] = None,
) -> Tuple[NDArray[Any], NDArray[np.float64]]: ...
def read_scalars(
    path: Path,
    *,
    xform: Literal["agreed", "qform", "sform", "none"] = 'agreed',
    frame: Optional[int] = None,
) -> Tuple[NDArray[Any], NDArray[np.float64]]: ...
def read_surface(
    path: Path,
    *,
    surface_space: Literal["stated", "scanner", "tkr"] = 'stated',
    fs_volume: Optional[str] = None,
) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def read_vertex_labels(path: Path, vertex_count: Optional[int] = None) -> Dict[str, Any]: ...
def read_vertex_maps(path: Path) -> Dict[str, Any]: ...
def rectangle(
    columns: int,
    rows: int,
    width: float,
    height: float,
) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def segment(
    intensity: Image,
    affine: Optional[ArrayLike] = None,
    mask: Optional[Image] = None,
    progress: Optional[Progress] = None,
    *,
    smooth: float = 0.1,
    bias_width: float = 40.0,
    max_iterations: int = 60,
    tolerance: float = 0.0005,
) -> Dict[str, Any]: ...
def segment_hemisphere(
    intensity: Image,
    atlas: Image,
    legend: str,
    affine: Optional[ArrayLike] = None,
    progress: Optional[Progress] = None,
    *,
    smooth: float = 0.1,
    bias_width: float = 40.0,
    max_iterations: int = 60,
    tolerance: float = 0.0005,
    hemisphere: Literal["both", "L", "R"] = 'L',
    core_depth: float = 2.0,
) -> Dict[str, Any]: ...
def select_region(
    surface: Surface,
    viewpoints: Optional[Union[Viewpoints, ArrayLike]] = None,
    *,
    center: Optional[ArrayLike] = None,
    vertex: Optional[int] = None,
    radius: float = 25.0,
    metric: Literal["euclidean", "geodesic"] = 'euclidean',
    cone: Optional[float] = None,
) -> Dict[str, Any]: ...
def self_intersections(surface: Surface) -> NDArray[np.int32]: ...
def self_occlusion(surface: Surface) -> float: ...
def set_threads(count: int) -> None: ...
def smallest_angles(surface: Surface) -> NDArray[np.float64]: ...
def subdivide(surface: Surface) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def surfaces_of(
    labels: Image,
    affine: Optional[ArrayLike] = None,
    progress: Optional[Progress] = None,
    *,
    preset: Literal["auto", "aseg", "ribbon", "three-class", "wm", "none"] = 'auto',
    white: Sequence[int] = ...,
    grey: Sequence[int] = ...,
    fill: Sequence[int] = ...,
    insulated: Sequence[int] = ...,
    hemisphere: Optional[Literal["L", "R"]] = None,
    no_fill: bool = False,
    close_edges: bool = False,
    genus: Literal["zero", "keep"] = 'zero',
    faces: int = 150000,
    steps: int = 12,
) -> Dict[str, Any]: ...
def surfaces_of_shares(
    white_share: Image,
    tissue_share: Image,
    affine: Optional[ArrayLike] = None,
    progress: Optional[Progress] = None,
    *,
    hemisphere: Optional[Literal["L", "R"]] = None,
    close_edges: bool = False,
    genus: Literal["zero", "keep"] = 'zero',
    faces: int = 150000,
    steps: int = 12,
) -> Dict[str, Any]: ...
def thickness(
    labels: Image,
    affine: Optional[ArrayLike] = None,
    recover_sulci: bool = True,
    progress: Optional[Progress] = None,
    *,
    inner: Sequence[int] = ...,
    tissue: Sequence[int] = ...,
    outer: Sequence[int] = ...,
    insulated: Sequence[int] = ...,
    boundary: Literal["subvoxel", "staircase", "embedding"] = 'subvoxel',
    open_ends: bool = False,
    per_slice: bool = False,
    facing: float = 100.0,
    method: Literal["hybrid", "eulerian", "lagrangian"] = 'hybrid',
    lambda_: Optional[float] = None,
    layers: int = 3,
    layer_kind: Literal["depth", "volume"] = 'depth',
) -> Dict[str, Any]: ...
def thickness_of_levels(
    inner: Image,
    outer: Image,
    affine: Optional[ArrayLike] = None,
    level: float = 0.0,
    recover_sulci: bool = True,
    progress: Optional[Progress] = None,
    *,
    boundary: Literal["subvoxel", "staircase", "embedding"] = 'subvoxel',
    open_ends: bool = False,
    per_slice: bool = False,
    facing: float = 100.0,
    method: Literal["hybrid", "eulerian", "lagrangian"] = 'hybrid',
    lambda_: Optional[float] = None,
    layers: int = 3,
    layer_kind: Literal["depth", "volume"] = 'depth',
) -> Dict[str, Any]: ...
def threads() -> int: ...
def torus(
    major_segments: int,
    minor_segments: int,
    major: float,
    minor: float,
) -> Tuple[NDArray[np.float64], NDArray[np.int32]]: ...
def unfold(
    surface: Surface,
    region: ArrayLike,
    viewpoints: Union[Viewpoints, ArrayLike],
    progress: Optional[Progress] = None,
    *,
    surround: Literal["fixed", "elastic", "none"] = 'fixed',
    collar_rings: int = 6,
    contact_range: float = 0.25,
    largest_move: float = 3.0,
    method: Literal["implicit", "thesis"] = 'implicit',
    knot: Literal["tree", "thesis-tree", "all-pairs", "off"] = 'off',
    keep_areas: bool = True,
    time_step: Optional[float] = None,
    area_weight: float = 20.0,
    spring_weight: float = 2.4,
    knot_weight: float = 0.0003,
    contact_weight: float = 0.2,
    lift_weight: float = 6.0,
    collar_weight: float = 0.0002,
    target_visibility: Optional[float] = None,
    area_tolerance: float = 0.002,
    max_iterations: int = 500,
    max_time: Optional[float] = None,
    frames: int = 0,
) -> Dict[str, Any]: ...
class Unfolder:
    def __init__(
        self,
        surface: Surface,
        region: ArrayLike,
        viewpoints: Union[Viewpoints, ArrayLike],
        *,
        surround: Literal["fixed", "elastic", "none"] = 'fixed',
        collar_rings: int = 6,
        contact_range: float = 0.25,
        largest_move: float = 3.0,
        method: Literal["implicit", "thesis"] = 'implicit',
        knot: Literal["tree", "thesis-tree", "all-pairs", "off"] = 'off',
        keep_areas: bool = True,
        time_step: Optional[float] = None,
        area_weight: float = 20.0,
        spring_weight: float = 2.4,
        knot_weight: float = 0.0003,
        contact_weight: float = 0.2,
        lift_weight: float = 6.0,
        collar_weight: float = 0.0002,
    ) -> None: ...
    def step(self, count: int = 1) -> bool: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def record(self) -> Dict[str, Any]: ...
    @property
    def region(self) -> Dict[str, Any]: ...
    def set_viewpoints(self, viewpoints: Union[Viewpoints, ArrayLike]) -> None: ...
    def set_region(self, vertices: ArrayLike) -> None: ...
    def set_weights(
        self,
        *,
        area_weight: float = 20.0,
        spring_weight: float = 2.4,
        knot_weight: float = 0.0003,
        contact_weight: float = 0.2,
        lift_weight: float = 6.0,
        collar_weight: float = 0.0002,
    ) -> None: ...
class UsageError(ValueError): ...
def vertex_areas(surface: Surface) -> NDArray[np.float64]: ...
def vertex_flux(
    surface: Surface,
    viewpoints: Union[Viewpoints, ArrayLike],
) -> NDArray[np.float64]: ...
def vertex_normals(surface: Surface) -> NDArray[np.float64]: ...
def view_line(start: ArrayLike, end: ArrayLike, count: int = 8) -> Viewpoints: ...
def view_surface(surface: Surface) -> Viewpoints: ...
class Viewpoints:
    def __init__(self, points: ArrayLike, weights: Optional[ArrayLike] = None) -> None: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def weights(self) -> NDArray[np.float64]: ...
    def __len__(self) -> int: ...
def visible_fraction(
    surface: Surface,
    viewpoints: Union[Viewpoints, ArrayLike],
    subdivision: int = 3,
) -> Dict[str, Any]: ...
def wall_segments(
    labels: Image,
    insertion: ArrayLike,
    affine: Optional[ArrayLike] = None,
    progress: Optional[Progress] = None,
    *,
    inner: Sequence[int] = ...,
    tissue: Sequence[int] = ...,
    outer: Sequence[int] = ...,
    insulated: Sequence[int] = ...,
    boundary: Literal["subvoxel", "staircase", "embedding"] = 'subvoxel',
    open_ends: bool = False,
    per_slice: bool = False,
    facing: float = 100.0,
    method: Literal["hybrid", "eulerian", "lagrangian"] = 'hybrid',
    lambda_: Optional[float] = None,
    layers: int = 3,
    layer_kind: Literal["depth", "volume"] = 'depth',
) -> Dict[str, Any]: ...
def winding_number(surface: Surface, point: ArrayLike) -> float: ...
def write_curv(path: Path, values: ArrayLike, face_count: int) -> None: ...
def write_label(
    path: Path,
    keys: ArrayLike,
    names: Dict[str, Any],
    structure: str = 'Other',
) -> None: ...
def write_shape(path: Path, maps: Dict[str, Any], structure: str = 'Other') -> None: ...
def write_surface(
    path: Path,
    surface: Surface,
    structure: str = 'Other',
    secondary: str = '',
) -> None: ...
def write_volume(path: Path, image: Image, affine: Optional[ArrayLike] = None) -> None: ...
