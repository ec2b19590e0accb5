# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Records of how results came about: checked, read, told."""

from ._explica.provenance import history, prov_json, read_record, sha256, software, verify

__all__ = ["history", "prov_json", "read_record", "sha256", "software", "verify"]
