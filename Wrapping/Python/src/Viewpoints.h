// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Visibility/Viewpoints.h"

#include <pybind11/pybind11.h>

namespace explica::python {

/// Binds visibility::Viewpoints, to which a point (3,) or points (N, 3) of equal weight convert, so
/// that a function that takes viewpoints takes all three.
void bindViewpoints(pybind11::module_& m);

}  // namespace explica::python
