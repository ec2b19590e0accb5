// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Flattening/Comparison.h"
#include "Explica/Flattening/Cuts.h"
#include "Explica/Flattening/FlatGrid.h"
#include "Explica/Flattening/Flatten.h"
#include "Explica/Flattening/FoldDepth.h"

namespace explica::python {
namespace {

using namespace py::literals;

std::vector<std::int32_t> listed(const TriangleMesh& mesh,
                                 const std::optional<std::vector<std::int32_t>>& faces) {
  if (!faces) return mesh.allFaces();
  requireFaces(mesh, *faces, "region");
  return *faces;
}

void bindFlatMaps(py::module_& m) {
  defWithOptions<flattening::FlattenOptions>(
      m, "flatten",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::optional<std::vector<std::int32_t>>& region, const py::object& progress,
         const py::kwargs& keywords) {
        const auto options = optionsOf<flattening::FlattenOptions>(keywords);
        const TriangleMesh mesh = meshOf(positions, faces);
        const auto disc = flattening::discOf(mesh, listed(mesh, region));
        auto map = Watch(progress).run(
            [&](const Monitor& monitor) { return flattening::flatten(disc, options, monitor); });
        py::list frames;
        for (const auto& frame : map.frames) frames.append(Eigen::MatrixXd(frame));
        return py::dict("positions"_a = Eigen::MatrixXd(map.positions), "faces"_a = disc.mesh.faces,
                        "frames"_a = frames, "vertices"_a = columnOf(disc.vertexOrigin),
                        "region"_a = columnOf(disc.faceOrigin), "turned_over"_a = map.turnedOver,
                        "rim_crossings"_a = map.rimCrossings, "iterations"_a = map.iterations,
                        "termination"_a = std::string(nameOf(map.termination)));
      },
      "The flat map of a surface with a rim, or of the listed faces: `positions` (N, 2) in mm,\n"
      "`faces` (F, 3) of these N vertices, counter-clockwise; `vertices` (N,) and `region` (F,) "
      "are\n"
      "their numbers in the surface.  No face is turned over and no part lies on another:\n"
      "`turned_over` and `rim_crossings`, both exact, are 0; so it is of a run that is stopped\n"
      "where `progress(fraction, activity)` returns False.  `frames` holds the\n"
      "positions on the way from a circle, as many as `frames=` asks for.",
      "positions"_a, "faces"_a, "region"_a = py::none(), "progress"_a = py::none());
  defWithOptions<flattening::CutOptions>(
      m, "relief_cuts",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::optional<std::vector<std::int32_t>>& region, const py::object& progress,
         const py::kwargs& keywords) {
        const auto options = optionsOf<flattening::CutOptions>(keywords);
        const TriangleMesh mesh = meshOf(positions, faces);
        const auto disc = flattening::discOf(mesh, listed(mesh, region));
        const auto plan = Watch(progress).run([&](const Monitor& monitor) {
          const Eigen::VectorXd depth = flattening::foldDepth(mesh)(disc.vertexOrigin);
          return flattening::findCuts(disc, depth, options, monitor);
        });
        std::vector<flattening::CutPath> paths;
        py::list cuts;
        std::vector<double> lengths;
        for (const flattening::Cut& cut : plan.cuts) {
          paths.push_back(cut.path);
          lengths.push_back(cut.length);
          flattening::CutPath named;
          for (const std::int32_t v : cut.path) named.push_back(disc.vertexOrigin[v]);
          cuts.append(columnOf(named));
        }
        const auto opened = flattening::openedAlong(disc, paths);
        return py::dict("faces"_a = opened.mesh.faces, "vertices"_a = columnOf(opened.vertexOrigin),
                        "region"_a = columnOf(opened.faceOrigin), "cuts"_a = cuts,
                        "lengths"_a = columnOf(lengths), "strain_before"_a = plan.strainBefore,
                        "strain"_a = plan.edgeStrain);
      },
      "Cuts along the folds by which a surface with a rim, or the listed faces, can be laid flat.\n"
      "`cuts`: the vertices along each, from the rim or an earlier cut inwards; `lengths` in mm;\n"
      "`faces` (F, 3) of the surface opened along them, whose N vertices are the surface's "
      "`vertices`\n"
      "(N,), those on cuts there twice; `region` (F,) their numbers in it; edge strain of the map "
      "without and with them.",
      "positions"_a, "faces"_a, "region"_a = py::none(), "progress"_a = py::none());
}

void bindFlatMeasures(py::module_& m) {
  m.def(
      "distance_errors",
      [](const PositionsIn& before, const FacesIn& faces, const PositionsIn& after, int pairs,
         int sources, double local_limit) {
        const TriangleMesh reference = meshOf(before, faces), deformed = meshOf(after, faces);
        if (before.rows() != after.rows()) throw InvalidInput("after: as many vertices as before");
        const auto all = listed(reference, {});
        return unlocked([&] {
          flattening::DistanceOptions options{
              .pairs = pairs, .sources = sources, .localLimit = local_limit};
          const auto drawn = flattening::drawPairs(reference, all, options);
          const auto kind = flattening::isFlatMap(deformed, all)
                                ? flattening::DistanceKind::Straight
                                : flattening::DistanceKind::Surface;
          return std::pair{flattening::distanceError(drawn.local, deformed, all, kind).error,
                           flattening::distanceError(drawn.all, deformed, all, kind).error};
        });
      },
      "positions"_a, "faces"_a, "after"_a, "pairs"_a = flattening::DistanceOptions{}.pairs,
      "sources"_a = flattening::DistanceOptions{}.sources,
      "local_limit"_a = flattening::DistanceOptions{}.localLimit,
      "Relative errors (local, all) of distances between vertices, each at its best scale: along\n"
      "the surface beside straight ones on the flat map `after` (V, 3), or ones along any other "
      "one.");
  m.def(
      "flat_grid",
      [](const PositionsIn& flat, const FacesIn& faces, const PositionsIn& inner,
         const PositionsIn& outer, double cell, int depths) {
        if (flat.rows() != inner.rows() || flat.rows() != outer.rows()) {
          throw InvalidInput("inner, outer: as many vertices as the flat map");
        }
        const flattening::FlatSheet sheet{meshOf(flat, faces).faces, flat, inner, outer};
        auto points = unlocked([&] { return flattening::flatGrid(sheet, {cell, depths}); });
        const Eigen::Matrix4d affine = points.grid.affine();
        return py::make_tuple(arrayOf(std::move(points)), affine);
      },
      "positions"_a, "faces"_a, "inner"_a, "outer"_a, "cell"_a = flattening::FlatGridOptions{}.cell,
      "depths"_a = flattening::FlatGridOptions{}.depths,
      "Cells of `cell` mm over a flat map (z = 0): their RAS places (I, J, depths, 3) between the\n"
      "surfaces inner and outer (V, 3), NaN off the map, and the affine from cells to u, v (mm) "
      "and depth.");
}

}  // namespace

void bindFlattening(py::module_& m) {
  bindFlatMaps(m);
  bindFlatMeasures(m);
}

}  // namespace explica::python
