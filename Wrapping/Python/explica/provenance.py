# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What this module was built from; each folder's provenance.json tells how results came about."""

from ._explica.provenance import software

__all__ = ["software"]
