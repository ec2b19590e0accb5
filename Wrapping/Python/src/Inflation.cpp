// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Inflation/Inflate.h"
#include "Explica/Visibility/SphereView.h"

namespace explica::python {
namespace {

using namespace py::literals;

}  // namespace

void bindInflation(py::module_& m) {
  defWithOptions<inflation::InflateOptions>(
      m, "inflate",
      [](const PositionsIn& positions, const FacesIn& faces, const py::object& progress,
         const py::kwargs& keywords) {
        const auto options = optionsOf<inflation::InflateOptions>(keywords);
        const TriangleMesh mesh = meshOf(positions, faces);
        auto result = Watch(progress).run(
            [&](const Monitor& monitor) { return inflation::inflate(mesh, options, monitor); });
        py::list frames;
        for (auto& frame : result.frames) {
          frames.append(py::make_tuple(frame.visibility, py::cast(std::move(frame.positions))));
        }
        const inflation::InflateRecord& last = result.history.back();
        return py::dict(
            "positions"_a = std::move(result.mesh.positions), "visibility"_a = last.visibility,
            "seen"_a = last.seen, "area_error_mean"_a = last.step.areaErrorMean,
            "edge_strain_mean"_a = last.step.edgeStrainMean, "iterations"_a = last.step.iteration,
            "termination"_a = std::string(nameOf(result.termination)),
            "flag"_a = std::string(nameOf(result.flag)), "frames"_a = frames);
      },
      "Open a closed surface as a whole until it is seen from all around, areas kept, nowhere\n"
      "through itself.  Returns positions (V, 3), visibility (global) and seen (share of the "
      "area)\n"
      "at the end, area_error_mean, edge_strain_mean, iterations, termination, flag ('', 'held' "
      "or\n"
      "'worse') and frames [(visibility, positions)].  `progress(fraction, activity)` may return\n"
      "False to stop.",
      "positions"_a, "faces"_a, "progress"_a = py::none());
  m.def(
      "sphere_view",
      [](const PositionsIn& positions, const FacesIn& faces, int viewpoints) {
        const TriangleMesh mesh = meshOf(positions, faces);
        auto view = unlocked([&] {
          return visibility::lookFromSphere(mesh, visibility::enclosingSphere(mesh, viewpoints));
        });
        return py::dict("direction"_a = std::move(view.direction),
                        "share"_a = std::move(view.share), "seen"_a = std::move(view.seen),
                        "visibility"_a = view.visibility, "seen_share"_a = view.seenShare);
      },
      "positions"_a, "faces"_a, "viewpoints"_a = inflation::InflateOptions{}.viewpoints,
      "What an enclosing sphere sees of a closed surface, by casting a ray from each face to each\n"
      "viewpoint: mean direction (F, 3) in which a face sees the sphere, share (F,) of the flux\n"
      "from before it that arrives, seen (F,) from anywhere, and their means by area, visibility\n"
      "(1 for convex surfaces only) and seen_share.");
}

}  // namespace explica::python
