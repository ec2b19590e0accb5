// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Unfolding/Unfold.h"

namespace explica::python {
namespace {

using namespace py::literals;
using unfolding::IterationRecord;
using unfolding::Unfolder;
using visibility::Viewpoints;

py::dict recordOf(const IterationRecord& r) {
  py::dict record("iteration"_a = r.iteration);
  for (const unfolding::EvolutionColumn& column : unfolding::evolutionColumns()) {
    record[column.name.c_str()] = column.of(r);
  }
  for (const char* count : {"contacts", "solves"}) {
    record[count] = static_cast<int>(record[count].cast<double>());
  }
  record["phase"] = std::string(nameOf(r.phase));
  return record;
}

unfolding::Region regionOf(const TriangleMesh& mesh, const std::vector<std::int32_t>& vertices) {
  std::vector<bool> marked(static_cast<std::size_t>(mesh.vertexCount()), false);
  for (const std::int32_t v : vertices) {
    if (v < 0 || v >= mesh.vertexCount()) {
      throw InvalidInput("region: vertex " + std::to_string(v) + " is not one of 0.." +
                         std::to_string(mesh.vertexCount() - 1));
    }
    marked[v] = true;
  }
  return unfolding::regionOfMarked(mesh, marked);
}

py::dict regionDict(const unfolding::Region& region) {
  return py::dict("vertices"_a = columnOf(region.vertices), "faces"_a = columnOf(region.faces),
                  "centre"_a = region.centre, "radius"_a = region.radius,
                  "pieces"_a = region.pieces, "holes"_a = region.holes);
}

py::dict resultDict(unfolding::UnfoldResult result) {
  py::list history;
  for (const IterationRecord& record : result.history) history.append(recordOf(record));
  py::list frames;
  for (auto& frame : result.frames) {
    frames.append(py::make_tuple(frame.visibility, py::cast(std::move(frame.positions))));
  }
  return py::dict("positions"_a = std::move(result.mesh.positions),
                  "faces"_a = std::move(result.mesh.faces),
                  "termination"_a = std::string(nameOf(result.termination)),
                  "flag"_a = std::string(nameOf(result.flag)), "iteration"_a = result.iteration,
                  "collar"_a = columnOf(result.collar), "history"_a = history, "frames"_a = frames);
}

/// The solver of unfold() with these options.
unfolding::UnfolderOptions asUnfoldHas(unfolding::UnfolderOptions options) {
  unfolding::UnfoldOptions whole;
  whole.unfolder = std::move(options);
  return unfolding::solverOptions(whole);
}

/// An unfolder that can be given another region on the way; Python's face of unfolding::Unfolder.
class Stepper {
 public:
  Stepper(TriangleMesh mesh, const std::vector<std::int32_t>& region, Viewpoints viewpoints,
          unfolding::UnfolderOptions options)
      : mesh_(std::move(mesh)),
        viewpoints_(std::move(viewpoints)),
        options_(asUnfoldHas(std::move(options))),
        unfolder_(mesh_, regionOf(mesh_, region), viewpoints_, options_) {}

  bool step(int count) {
    for (int n = 0; n < count; ++n) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!unlocked([&] { return unfolder_.step(); })) return false;
    }
    return true;
  }

  /// Lengths and areas to be kept are still those of the surface given at construction.
  void setRegion(const std::vector<std::int32_t>& vertices) {
    Unfolder next(mesh_, regionOf(mesh_, vertices), viewpoints_, options_);
    unfolding::UnfoldState state = next.state();
    state.positions = unfolder_.state().positions;
    state.iteration = unfolder_.state().iteration;
    next.restore(std::move(state));
    unfolder_ = std::move(next);
  }

  void setViewpoints(Viewpoints viewpoints) {
    viewpoints_ = viewpoints;
    unfolder_.setViewpoints(std::move(viewpoints));
  }

  [[nodiscard]] const Unfolder& unfolder() const { return unfolder_; }

 private:
  TriangleMesh mesh_;
  Viewpoints viewpoints_;
  unfolding::UnfolderOptions options_;
  Unfolder unfolder_;
};

}  // namespace

void bindUnfolding(py::module_& m) {
  defWithOptions<unfolding::RegionOptions>(
      m, "select_region",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::optional<Viewpoints>& viewpoints, const py::kwargs& keywords) {
        const auto options = optionsOf<unfolding::RegionOptions>(keywords);
        const TriangleMesh mesh = meshOf(positions, faces);
        return regionDict(
            unfolding::selectRegion(mesh, options, viewpoints ? &*viewpoints : nullptr));
      },
      "A region of a surface: vertices and faces (ascending), centre, radius in mm, pieces, "
      "holes.\n"
      "`viewpoints` are needed for a cone only.",
      "positions"_a, "faces"_a, "viewpoints"_a = py::none());
  defWithOptions<unfolding::UnfoldOptions>(
      m, "unfold",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::vector<std::int32_t>& region, const Viewpoints& viewpoints,
         const py::object& progress, const py::kwargs& keywords) {
        const auto options = optionsOf<unfolding::UnfoldOptions>(keywords);
        const TriangleMesh mesh = meshOf(positions, faces);
        geometry::requireManifold(mesh, "surface");
        const unfolding::Region chosen = regionOf(mesh, region);
        return resultDict(Watch(progress).run([&](const Monitor& monitor) {
          return unfolding::unfold(mesh, chosen, viewpoints, options, monitor);
        }));
      },
      "Unfold the region (its vertices) of a surface for viewpoints, RAS mm.  Returns positions\n"
      "(V, 3), faces, termination, flag ('', 'held', 'worse' or 'stretched'),\n"
      "iteration (whose state it is), collar (faces that moved outside the region), history (one\n"
      "dict an iteration) and frames\n"
      "[(visibility, positions)].  `progress(fraction, activity)` may return False to stop.",
      "positions"_a, "faces"_a, "region"_a, "viewpoints"_a, "progress"_a = py::none());
  m.def(
      "distortion",
      [](const PositionsIn& positions, const FacesIn& faces, const PositionsIn& deformed,
         const std::vector<std::int32_t>& region) {
        const TriangleMesh mesh = meshOf(positions, faces);
        requireFaces(mesh, region, "region");
        const Positions now = deformed;
        auto d = unlocked([&] { return unfolding::measureDistortion(mesh, now, region); });
        return py::dict(
            "area_ratio"_a = std::move(d.areaRatio),
            "angle_error_rad"_a = std::move(d.angleErrorRad),
            "edge_strain"_a = std::move(d.edgeStrain), "area_error_mean"_a = d.areaErrorMean,
            "area_error_max"_a = d.areaErrorMax, "angle_error_mean_rad"_a = d.angleErrorMeanRad,
            "edge_strain_mean"_a = d.edgeStrainMean, "edge_strain_p95"_a = d.edgeStrainP95);
      },
      "positions"_a, "faces"_a, "deformed"_a, "region"_a,
      "How the listed faces differ between two embeddings of the same mesh, the surface and\n"
      "`deformed` (V, 3), mm: area_ratio and angle_error_rad of each face, edge_strain of each "
      "edge,\n"
      "their means and maxima.");
  m.def(
      "backfacing_share",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::vector<std::int32_t>& region, const Viewpoints& viewpoints) {
        const TriangleMesh mesh = meshOf(positions, faces);
        requireFaces(mesh, region, "region");
        return unfolding::backfacingShare(mesh, region, viewpoints);
      },
      "positions"_a, "faces"_a, "region"_a, "viewpoints"_a,
      "Share of the area of the listed faces that looks away from the viewpoints, in [0, 1].");

  noteKeywords<unfolding::UnfolderOptions>(m, "Unfolder");
  py::class_<Stepper>(m, "Unfolder",
                      ("An unfolding advanced one iteration at a time, to be watched and steered." +
                       keywordHelp<unfolding::UnfolderOptions>())
                          .c_str())
      .def(py::init([](const PositionsIn& positions, const FacesIn& faces,
                       const std::vector<std::int32_t>& region, const Viewpoints& viewpoints,
                       const py::kwargs& keywords) {
             return std::make_unique<Stepper>(meshOf(positions, faces), region, viewpoints,
                                              optionsOf<unfolding::UnfolderOptions>(keywords));
           }),
           "positions"_a, "faces"_a, "region"_a, "viewpoints"_a)
      .def("step", &Stepper::step, "count"_a = 1,
           "Advance; False once no further step lowers the objective.")
      .def_property_readonly(
          "positions", [](const Stepper& s) -> Positions { return s.unfolder().state().positions; },
          "All vertices now, (V, 3), RAS mm.")
      .def_property_readonly(
          "record", [](const Stepper& s) { return recordOf(s.unfolder().record()); },
          "Visibility, energies, errors and contacts after the last iteration.")
      .def_property_readonly(
          "region", [](const Stepper& s) { return regionDict(s.unfolder().region()); },
          "Vertices and faces of the region.")
      .def("set_viewpoints", &Stepper::setViewpoints, "viewpoints"_a,
           "Look from elsewhere, one point or several, RAS mm, from the next step on.")
      .def("set_region", &Stepper::setRegion, "vertices"_a,
           "Unfold another region from the next step on; what moved so far stays where it is, and\n"
           "areas and lengths to keep are those of the first surface.");
}

}  // namespace explica::python
