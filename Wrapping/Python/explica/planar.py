# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The theory in the plane: polygons (V, 2) in millimetres, counter-clockwise, closed from the last
vertex to the first; a region is a pair of its first and last vertex."""

from ._explica import planar as _compiled
from ._explica.planar import (
    circle,
    edge_lengths,
    ellipse,
    hidden_viewing_arc,
    knot_energy,
    largest_safe_step,
    polygon19,
    polygon34,
    read_polygon,
    resample,
    self_intersections,
    self_occlusion,
    signed_area,
    unfold,
    visibility,
    visible_part,
    write_polygon,
)
from ._images import of_image as _of_image

contours_of_label = _of_image("labels", module=_compiled)(_compiled.contours_of_label)
contours_of_level = _of_image("field", module=_compiled)(_compiled.contours_of_level)

__all__ = [name for name in dir() if not name.startswith("_")]
