# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Runs and studies: what a run would do, who takes part, what came out."""

from ._explica.study import find_participants, hearts, plan, table

__all__ = ["find_participants", "hearts", "plan", "table"]
