// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Watch.h"

#include "Explica/Core/Errors.h"
#include "Explica/Repulsion/KnotEnergy.h"

namespace explica::python {
namespace {

using namespace py::literals;
using PositionsIn = Eigen::Ref<const Positions>;
using FacesIn = Eigen::Ref<const Faces>;

/// Python's face of repulsion::KnotEnergy: checks what evaluate() demands.
class Evaluator {
 public:
  Evaluator(const TriangleMesh& mesh, const std::optional<std::vector<bool>>& moves,
            const std::string& method)
      : vertices_(mesh.vertexCount()) {
    const std::vector<bool> every(static_cast<std::size_t>(mesh.vertexCount()), true);
    energy_ = repulsion::makeKnotEnergy(valueOf<repulsion::KnotMethod>(method), mesh,
                                        moves ? *moves : every);
    if (!energy_) throw InvalidInput("method: 'off' has no energy");
  }

  [[nodiscard]] std::pair<double, Positions> evaluate(const PositionsIn& positions) const {
    if (positions.rows() != vertices_) {
      throw InvalidInput("positions: has " + std::to_string(positions.rows()) + " rows, " +
                         std::to_string(vertices_) + " vertices are known");
    }
    const Positions at = positions;
    auto value = unlocked([&] { return energy_->evaluate(at); });
    return std::make_pair(value.value, std::move(value.gradient));
  }

 private:
  Eigen::Index vertices_;
  std::unique_ptr<repulsion::KnotEnergy> energy_;
};

constexpr const char* kMethods =
    "method: 'tree' (multipole tree, relative error about 1e-3), 'thesis-tree' (merging tree) or\n"
    "'all-pairs' (exact to about 1e-6, slow).";

}  // namespace

void bindRepulsion(py::module_& m) {
  m.def(
      "knot_energy",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::optional<std::vector<bool>>& moves, const std::string& method) {
        return Evaluator(meshOf(positions, faces), moves, method).evaluate(positions);
      },
      "positions"_a, "faces"_a, "moves"_a = py::none(), "method"_a = "tree",
      ("Knot energy, mm^2, and its gradient (V, 3), mm, which motion descends; `moves` (V,) marks\n"
       "the vertices that may move (default: all).\n" +
       std::string(kMethods))
          .c_str());
  py::class_<Evaluator>(
      m, "KnotEnergy",
      ("Knot energy made ready for one surface, to be evaluated at many positions of its moving\n"
       "vertices; those that `moves` (V,) does not mark must stay.\n" +
       std::string(kMethods))
          .c_str())
      .def(py::init([](const PositionsIn& positions, const FacesIn& faces,
                       const std::optional<std::vector<bool>>& moves, const std::string& method) {
             return std::make_unique<Evaluator>(meshOf(positions, faces), moves, method);
           }),
           "positions"_a, "faces"_a, "moves"_a = py::none(), "method"_a = "tree")
      .def("evaluate", &Evaluator::evaluate, "positions"_a,
           "(value, gradient) at positions (V, 3), mm: value in mm^2, gradient (V, 3) in mm.");
}

}  // namespace explica::python
