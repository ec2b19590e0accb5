// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace explica::python {

// One function a module, each in a source of its own; Provenance into a submodule.
void bindCore(pybind11::module_& m);
void bindGeometry(pybind11::module_& m);
void bindIO(pybind11::module_& m);
void bindAnnular(pybind11::module_& m);
void bindCortex(pybind11::module_& m);
void bindVisibility(pybind11::module_& m);
void bindSampling(pybind11::module_& m);
void bindUnfolding(pybind11::module_& m);
void bindFlattening(pybind11::module_& m);
void bindProvenance(pybind11::module_& m);

}  // namespace explica::python
