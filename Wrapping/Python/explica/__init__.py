# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Explica: measure layered tissue such as cortex or the heart wall, and unfold it for a chosen viewpoint.

Arrays go in and come out as numpy arrays.  Images are arrays of shape (I, J, K) with a 4 x 4 affine
from index to RAS millimetres, as in nibabel; surfaces are positions (V, 3) in RAS millimetres and
faces (F, 3), counter-clockwise seen from outside.  Wherever an image is wanted, a nibabel image does
as well, and wherever a surface is wanted, a nibabel GIFTI image or a file's path.

Options are keyword arguments with the names and defaults of the command line: `--max-iterations 100`
is `max_iterations=100`.
"""

from . import provenance, types
from ._explica import (
    Error,
    FileError,
    InvalidInput,
    MachineError,
    UsageError,
    Viewpoints,
    folded_sphere,
    icosphere,
    read_labels,
    read_scalars,
    read_surface,
    read_vertex_labels,
    read_vertex_maps,
    set_threads,
    threads,
    view_line,
    write_curv,
    write_label,
    write_shape,
)
from ._commands import command, executable
from ._images import (
    anatomical_grid,
    surfaces_of,
    thickness,
    thickness_of_levels,
    write_volume,
)
from ._sampling import nearest_columns, positions_at_depth, sample
from ._surfaces import *  # every function of a surface

__version__ = provenance.software()["version"]
__all__ = [name for name in dir() if not name.startswith("_")]
