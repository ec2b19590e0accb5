// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Bindings.h"

#include "Explica/Core/Memory.h"

PYBIND11_MODULE(_explica, m) {
  m.doc() = "Explica's compiled functions; import `explica` instead.";
  explica::fixBlocksOfProducts();
  explica::python::bindCore(m);
  explica::python::bindGeometry(m);
  explica::python::bindIO(m);
  explica::python::bindAnnular(m);
  explica::python::bindCortex(m);
  explica::python::bindVisibility(m);
  explica::python::bindSampling(m);
  explica::python::bindUnfolding(m);
  explica::python::bindFlattening(m);
  explica::python::bindProvenance(m);
}
