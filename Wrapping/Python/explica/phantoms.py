# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Generated tissues whose answers are known exactly."""

from ._explica.phantoms import annulus, cortex, shell

__all__ = ["annulus", "cortex", "shell"]
