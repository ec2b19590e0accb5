# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
from typing import Any, Dict, List, Literal, Optional, Sequence

from .types import Path

def find_participants(dataset: Path, labels: Sequence[str] = ...) -> List[Dict[str, Any]]: ...
def plan(
    input: Path,
    out: Path,
    atlas: Optional[str] = None,
    *,
    kind: Literal["auto", "t1", "labels", "freesurfer", "bids"] = 'auto',
    hemisphere: Literal["L", "R"] = 'L',
    unfold_surface: Literal["white", "mid", "pial"] = 'mid',
    given_surfaces: Literal["use", "remake"] = 'use',
    steps: Sequence[Literal["segment", "thickness", "surface", "unfold", "report"]] = ...,
) -> List[Dict[str, Any]]: ...
def table(out: Path) -> List[Dict[str, Any]]: ...
