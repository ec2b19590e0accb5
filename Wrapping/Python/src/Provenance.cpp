// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Software.h"

namespace explica::python {
namespace {

using namespace py::literals;

}  // namespace

void bindProvenance(py::module_& parent) {
  py::module_ m = parent.def_submodule("provenance");
  m.def(
      "software",
      [] {
        const auto& s = provenance::software();
        return py::dict("version"_a = s.version, "commit"_a = s.commit, "dirty"_a = s.dirty,
                        "build_type"_a = s.buildType, "compiler"_a = s.compiler,
                        "libraries"_a = pythonOf(provenance::describeLibraries()));
      },
      "Version, commit, dirty flag, build_type, compiler and libraries of this build.");
}

}  // namespace explica::python
