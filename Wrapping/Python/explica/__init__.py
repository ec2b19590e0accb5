# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Explica: measure folded annular tissue, and unfold it for a chosen viewpoint.

Arrays go in and come out as numpy arrays.  Images are arrays of shape (I, J, K) with a 4 x 4 affine
from index to RAS millimetres, as in nibabel; surfaces are positions (V, 3) in RAS millimetres and
faces (F, 3), counter-clockwise seen from outside.  Wherever an image is wanted, a nibabel image does
as well, and wherever a surface is wanted, a nibabel GIFTI image or a file's path.

Options are keyword arguments with the names and defaults of the command line: `--max-iterations 100`
is `max_iterations=100`.
"""

from ._explica import (
    Error,
    FileError,
    InvalidInput,
    MachineError,
    UsageError,
    set_threads,
    threads,
)
from .images import read_labels, read_scalars, write_volume
from .surfaces import (
    closest_points,
    enclosed_volume,
    face_areas,
    folded_sphere,
    geodesic_distances,
    icosphere,
    inspect_mesh,
    read_surface,
    read_vertex_maps,
    self_intersections,
    vertex_areas,
    vertex_normals,
    write_shape,
    write_surface,
)
from .tissue import segment, surfaces_of, thickness, thickness_of_levels
from .unfolding import (
    Unfolder,
    average_visibility,
    distortion,
    knot_energy,
    select_region,
    unfold,
    visible_fraction,
)

__all__ = [name for name in dir() if not name.startswith("_")]
