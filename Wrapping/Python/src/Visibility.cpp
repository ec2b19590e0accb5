// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Viewpoints.h"
#include "Watch.h"

#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/VisibleFraction.h"

namespace explica::python {
namespace {

using namespace py::literals;
using visibility::Viewpoints;

}  // namespace

void bindVisibility(py::module_& m) {
  bindViewpoints(m);
  m.def(
      "average_visibility",
      [](const PositionsIn& positions, const FacesIn& faces, const Viewpoints& viewpoints,
         std::optional<std::vector<std::int32_t>> region) {
        const TriangleMesh mesh = meshOf(positions, faces);
        auto value = unlocked([&] {
          return visibility::AverageVisibility(mesh.faces, region ? *region : mesh.allFaces(),
                                               viewpoints)
              .evaluate(mesh.positions);
        });
        return py::dict("value"_a = value.value, "area"_a = value.area,
                        "gradient"_a = std::move(value.gradient),
                        "face_flux"_a = std::move(value.faceFlux));
      },
      "positions"_a, "faces"_a, "viewpoints"_a, "region"_a = py::none(),
      "Average visibility of a region's faces (without region: all) from viewpoints, RAS mm:\n"
      "value in [-1, 1], area in mm^2, gradient (V, 3) in 1/mm, which ascends, and face_flux, the\n"
      "flux density of each region face in [-1, 1].");
  m.def(
      "vertex_flux",
      [](const PositionsIn& positions, const FacesIn& faces, const Viewpoints& viewpoints) {
        const TriangleMesh mesh = meshOf(positions, faces);
        return unlocked([&] { return visibility::vertexFlux(mesh, viewpoints); });
      },
      "positions"_a, "faces"_a, "viewpoints"_a,
      "Mean flux density of the faces at each vertex, (V,), in [-1, 1].");
  m.def(
      "visible_fraction",
      [](const PositionsIn& positions, const FacesIn& faces, const Viewpoints& viewpoints,
         int subdivision) {
        const TriangleMesh mesh = meshOf(positions, faces);
        auto seen =
            unlocked([&] { return visibility::visibleFraction(mesh, viewpoints, {subdivision}); });
        return py::dict("face"_a = std::move(seen.face), "vertex"_a = std::move(seen.vertex),
                        "total"_a = seen.total);
      },
      "positions"_a, "faces"_a, "viewpoints"_a,
      "subdivision"_a = visibility::VisibleFractionOptions{}.subdivision,
      "What is truly seen from viewpoints, RAS mm, by casting subdivision^2 rays a face: share of\n"
      "each face (F,), of the area around each vertex (V,), and of the whole (total).");
}

}  // namespace explica::python
