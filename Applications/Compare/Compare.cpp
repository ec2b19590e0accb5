// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Describing.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/Selection.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Report/Figure.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Comparison.h"

namespace explica::app {
namespace {

struct CompareSettings {
  std::string before;
  std::vector<std::string> after;
  io::SurfaceReadOptions reading;
  std::optional<std::string> label;
  std::optional<int> labelKey;
  flattening::DistanceOptions distances;
};

void declare(Declaration& d, CompareSettings& s) {
  d.synopsis("area, length, angle and distance distortion of surfaces against a reference")
      .description(
          R"(Compares flat maps, inflated surfaces, spheres and unfolded surfaces with the surface that they came from, on the faces that all of them have. Area error, edge strain and angle change are means over faces and edges. Distances are measured on the reference along the surface, between the same pairs of vertices for all; on flat maps straight, on other surfaces along them; each kind of surface at the scale that suits it best. 'Turned over' and 'crossings' are exact. 'Seen' is the share of the area that rays reach: straight from above for a flat map, from all sides of an enclosing sphere for any other.

A run that is stopped holds the surfaces that it has measured, the first at any rate, and ends with exit code 3.)")
      .example("explica compare pial.surf.gii flat/flat.surf.gii inflated.surf.gii --out compared",
               "A flat map and an inflated surface beside the surface that they came from")
      .input("BEFORE", FileKind::Surface, "reference surface", s.before)
      .input("AFTER", FileKind::Surface, "surfaces with the same vertices", s.after)
      .options("Reading", s.reading)
      .inputOption("label", FileKind::VertexLabel, "compare only where this label is not 0",
                   s.label, "Region")
      .category("Region")
      .option("label-key", "compare only where --label has this key", s.labelKey)
      .needs({"label-key"}, {"label"})
      .category("Distances")
      .option({"pairs", "", "pairs of vertices in each of the two groups", 0, 1e8},
              s.distances.pairs)
      .option({"sources", "", "vertices from which the pairs are counted", 1, 1e6},
              s.distances.sources)
      .option({"local-limit", "mm", "pairs nearer than this are 'local'"}, s.distances.localLimit)
      .output("comparison.tsv", FileKind::Table, "one row a surface")
      .output("comparison-*.png", FileKind::Picture, "each surface, coloured by its area ratio")
      .results<unfolding::Comparison>();
}

/// The surface coloured by the logarithm of its area ratio.
void draw(const std::filesystem::path& path, const TriangleMesh& reference,
          const TriangleMesh& after, const std::vector<std::int32_t>& faces,
          const unfolding::Distortion& distortion) {
  const TriangleMesh whole{after.positions, reference.faces};
  const geometry::SubMesh part = geometry::extractFaces(whole, faces);
  const Eigen::VectorXd means = unfolding::vertexMeans(reference, faces, distortion.areaRatio, 1);
  report::SurfacePaint paint;
  paint.values.resize(part.mesh.vertexCount());
  for (Eigen::Index v = 0; v < part.mesh.vertexCount(); ++v) {
    paint.values[v] = std::log2(std::max(means[part.vertexOrigin[v]], 1e-6));
  }
  paint.scale = {report::ColourMap::Diverging, -1, 1, "area, doublings", ""};
  report::FigureView above;
  above.towards = Vector(0, 0, -1);
  above.up = Vector(0, 1, 0);
  report::FigureView left, right;
  left.name = report::ViewName::Left;
  right.name = report::ViewName::Right;
  const bool flat = flattening::isFlatMap(whole, faces);
  report::SurfacePictureOptions size{.width = flat ? 900 : 600, .height = flat ? 900 : 500};
  const auto views = flat ? std::vector{above} : std::vector{left, right};
  report::writePng(
      path, report::surfaceFigure(part.mesh, paint, views, static_cast<int>(views.size()), size));
}

Termination run(Context& context, const CompareSettings& s) {
  const auto reference = readSurface(context, "BEFORE", s.before, s.reading);
  geometry::requireManifold(reference.mesh, s.before);
  std::vector<TriangleMesh> surfaces;
  std::vector<std::int32_t> faces = reference.mesh.allFaces();
  for (const std::string& path : s.after) {
    const auto loaded = readSurface(context, path, path, s.reading);
    if (loaded.mesh.vertexCount() != reference.mesh.vertexCount()) {
      throw InvalidInput("'" + path + "': has " + std::to_string(loaded.mesh.vertexCount()) +
                         " vertices where '" + s.before + "' has " +
                         std::to_string(reference.mesh.vertexCount()) +
                         "; only surfaces with the same vertices can be compared");
    }
    faces = flattening::facesAlsoIn(reference.mesh.faces, faces, loaded.mesh.faces);
    surfaces.push_back(loaded.mesh);
  }
  if (s.label) {
    const auto labels = io::readVertexLabels(*s.label, reference.mesh.vertexCount());
    faces = flattening::facesWithin(reference.mesh.faces, faces, labels.keys, s.labelKey);
  }
  if (faces.empty()) throw InvalidInput("the surfaces have no face in common");
  sayHowRead(context, reference.origin);

  std::vector<std::string> names;
  for (const std::string& path : s.after) {
    names.push_back(std::filesystem::path(path).filename().string());
  }
  unfolding::Comparison compared;
  {
    auto step = context.step("compare");
    compared = unfolding::compareSurfaces(reference.mesh, surfaces, names, faces, s.distances,
                                          context.monitor());
  }
  const StopScope kept(nullptr);  // what is reached is written
  auto step = context.step("write");
  writeTextFile(context.output("comparison.tsv"), tableOf(compared.surfaces));
  const bool all = compared.surfaces.size() == surfaces.size();
  Termination end = all ? Termination::Finished : Termination::Interrupted;
  for (std::size_t n = 0; n < compared.surfaces.size(); ++n) {
    describing(context, end, [&] {
      draw(context.output("comparison-" + std::to_string(n + 1) + ".png"), reference.mesh,
           surfaces[n], faces, compared.surfaces[n].distortion);
    });
  }
  context.results(compared);
  return end;
}

}  // namespace

Command compareCommand() {
  return makeCommand<CompareSettings>("compare", declare, run);
}

}  // namespace explica::app
