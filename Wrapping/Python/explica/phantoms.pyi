# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
from typing import Any, Dict

from numpy.typing import ArrayLike

def annulus(kind: str, *, size: int = 128, spacing: float = 1.0) -> Dict[str, Any]: ...
def cortex(
    *,
    size: int = 64,
    spacing: float = 1.0,
    thickness: float = 2.5,
    depth: float = 0.25,
    waves: int = 5,
    noise: float = 3.0,
    bias: float = 0.1,
    seed: int = 1,
) -> Dict[str, Any]: ...
def shell(
    *,
    size: int = 64,
    spacing: float = 1.0,
    inner_radius: float = 0.5,
    outer_radius: float = 0.8,
    aspect: ArrayLike = ...,
) -> Dict[str, Any]: ...
