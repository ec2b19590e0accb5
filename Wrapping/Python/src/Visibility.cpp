// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Viewpoints.h"

#include "Explica/Repulsion/KnotEnergy.h"
#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <numeric>

namespace explica::python {

using PositionsIn = Eigen::Ref<const Positions>;
using FacesIn = Eigen::Ref<const Faces>;

visibility::Viewpoints viewpointsOf(const Eigen::Ref<const Positions>& points) {
  visibility::Viewpoints viewpoints;
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    viewpoints.points.emplace_back(points.row(n).transpose());
    viewpoints.weights.push_back(1.0 / static_cast<double>(points.rows()));
  }
  return viewpoints;
}

namespace {

std::vector<std::int32_t> everyFace(const TriangleMesh& mesh) {
  std::vector<std::int32_t> all(static_cast<std::size_t>(mesh.faceCount()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

void bindVisibility(py::module_& m) {
  using namespace py::literals;
  m.def(
      "average_visibility",
      [](const PositionsIn& positions, const FacesIn& faces, const PositionsIn& viewpoints,
         std::optional<std::vector<std::int32_t>> region) {
        const TriangleMesh mesh = meshOf(positions, faces);
        const visibility::AverageVisibility energy(mesh.faces, region ? *region : everyFace(mesh),
                                                   viewpointsOf(viewpoints));
        auto value = energy.evaluate(mesh.positions);
        return py::dict("value"_a = value.value, "area"_a = value.area,
                        "gradient"_a = std::move(value.gradient),
                        "face_flux"_a = std::move(value.faceFlux));
      },
      "positions"_a, "faces"_a, "viewpoints"_a, "region"_a = py::none(),
      "Average visibility of a region from viewpoints (N, 3), RAS mm: value in [-1, 1], area in "
      "mm^2,\n"
      "gradient (V, 3) in 1/mm, and flux density of each region face.  Without region: all faces.");
  m.def(
      "visible_fraction",
      [](const PositionsIn& positions, const FacesIn& faces, const PositionsIn& viewpoints) {
        auto seen = visibility::visibleFraction(meshOf(positions, faces), viewpointsOf(viewpoints));
        return py::dict("face"_a = std::move(seen.face), "vertex"_a = std::move(seen.vertex),
                        "total"_a = seen.total);
      },
      "positions"_a, "faces"_a, "viewpoints"_a,
      "What is truly seen from viewpoints (N, 3), by ray casting: share of each face (F,), of the "
      "area\n"
      "around each vertex (V,), and of the whole.");
  m.def(
      "knot_energy",
      [](const PositionsIn& positions, const FacesIn& faces, std::optional<std::vector<bool>> moves,
         const std::string& method) {
        const TriangleMesh mesh = meshOf(positions, faces);
        const std::vector<bool> free(static_cast<std::size_t>(mesh.vertexCount()), true);
        const auto energy = repulsion::makeKnotEnergy(valueOf<repulsion::KnotMethod>(method), mesh,
                                                      moves ? *moves : free);
        if (!energy) throw py::value_error("method: 'off' has no energy");
        auto value = energy->evaluate(mesh.positions);
        return py::make_tuple(value.value, py::cast(std::move(value.gradient)));
      },
      "positions"_a, "faces"_a, "moves"_a = py::none(), "method"_a = "tree",
      "Knot energy, mm^2, and its gradient (V, 3), mm; `moves` (V,) marks the vertices that may "
      "move.");
}

}  // namespace explica::python
