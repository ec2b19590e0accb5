# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Closed shapes as harmonic functions: fitted, averaged, combined; every convex combination of
shapes in one annulus is again one closed curve or surface."""

import os

from ._explica import shapes as _compiled
from ._explica.shapes import Shape, band, between, combine, concentric
from ._signature import prose, signature_of
from ._surfaces import as_mesh as _as_mesh


def _target(target):
    """A polygon's array as it is, any surface as (positions, faces)."""
    is_surface = isinstance(target, (str, os.PathLike, tuple)) or hasattr(target, "agg_data")
    return _as_mesh(target) if is_surface else target


def _of_targets(function):
    """Lets the arguments `target`, `targets` and `shape` of a compiled function be any surface."""
    signature = signature_of(function.__doc__, _compiled.keywords.get(function.__name__, []))
    names = list(signature.parameters)

    def call(*arguments, **keywords):
        keywords.update(zip(names, arguments))
        for name in ("target", "shape"):
            if name in keywords:
                keywords[name] = _target(keywords[name])
        if "targets" in keywords:
            keywords["targets"] = [_target(one) for one in keywords["targets"]]
        return function(**keywords)

    kinds = {"target": "Target", "shape": "Target", "targets": "Sequence[Target]"}
    call.__signature__ = signature.replace(
        parameters=[
            p.replace(annotation=kinds.get(p.name, p.annotation))
            for p in signature.parameters.values()
        ]
    )
    call.__name__ = call.__qualname__ = function.__name__
    call.__doc__ = prose(function.__doc__)
    return call


around = _of_targets(_compiled.around)
fit = _of_targets(_compiled.fit)
distance = _of_targets(_compiled.distance)


def average(shapes: "Iterable[Shape]") -> "Shape":
    """Mean of shapes of one annulus."""
    shapes = list(shapes)
    return combine(shapes, [1.0] * len(shapes))


__all__ = [
    "Shape",
    "around",
    "average",
    "band",
    "between",
    "combine",
    "concentric",
    "distance",
    "fit",
]
