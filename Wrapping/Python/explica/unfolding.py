# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Visibility, repulsion and unfolding of surfaces."""

import functools

import numpy as np

from . import _explica
from .surfaces import as_mesh, of_mesh


def _points(viewpoints):
    """Viewpoints as (N, 3), of one point or several."""
    return np.atleast_2d(np.asarray(viewpoints, dtype=np.float64))


def _seen_from(function, place):
    """Lets argument `place` (after the surface) of a compiled function be one point or several."""
    of_surface = of_mesh(function)

    @functools.wraps(of_surface)
    def call(surface, *arguments, **keywords):
        arguments = list(arguments)
        if len(arguments) > place:
            arguments[place] = _points(arguments[place])
        elif "viewpoints" in keywords:
            keywords["viewpoints"] = _points(keywords["viewpoints"])
        return of_surface(surface, *arguments, **keywords)

    return call


average_visibility = _seen_from(_explica.average_visibility, 0)
visible_fraction = _seen_from(_explica.visible_fraction, 0)
unfold = _seen_from(_explica.unfold, 1)
knot_energy = of_mesh(_explica.knot_energy)
select_region = of_mesh(_explica.select_region)
distortion = of_mesh(_explica.distortion)


class Unfolder(_explica.Unfolder):
    __doc__ = _explica.Unfolder.__doc__

    def __init__(self, surface, region, viewpoints, **options):
        super().__init__(*as_mesh(surface), region, _points(viewpoints), **options)

    def set_viewpoints(self, viewpoints):
        """Look from elsewhere, one point or several, from the next step on."""
        super().set_viewpoints(_points(viewpoints))
