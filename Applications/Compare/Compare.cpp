// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Describing.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Flattening/Seen.h"
#include "Explica/Flattening/Selection.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Report/Figure.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Distortion.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdio>
#include <numeric>

namespace explica::app {
namespace {

struct Settings {
  std::string before;
  std::vector<std::string> after;
  io::SurfaceReadOptions reading;
  std::optional<std::string> label;
  std::optional<int> labelKey;
  flattening::DistanceOptions distances;
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("surfaces with the same vertices beside a reference: what each keeps and what not")
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
      .option("Region", Field{"label-key", "", "compare only where --label has this key"},
              s.labelKey)
      .needs({"label-key"}, {"label"})
      .option("Distances",
              Field{"pairs", "", "pairs of vertices in each of the two groups", 0, 1e8},
              s.distances.pairs)
      .option("Distances",
              Field{"sources", "", "vertices from which the pairs are counted", 1, 1e6},
              s.distances.sources)
      .option("Distances", Field{"local-limit", "mm", "pairs nearer than this are 'local'"},
              s.distances.localLimit)
      .output("comparison.tsv", FileKind::Table, "one row a surface")
      .output("comparison-*.png", FileKind::Picture, "each surface, coloured by its area ratio");
}

struct Row {
  std::string name;
  unfolding::Distortion distortion;
  flattening::DistanceError local, all;
  std::int64_t turnedOver = 0;
  std::size_t crossings = 0;
  double seen = kNaN;
};

std::vector<std::int32_t> everyFace(const TriangleMesh& mesh) {
  std::vector<std::int32_t> faces(static_cast<std::size_t>(mesh.faceCount()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

Row measure(const TriangleMesh& reference, const TriangleMesh& after,
            const std::vector<std::int32_t>& faces, const flattening::DistancePairs& pairs) {
  Row row;
  unfolding::DistortionOptions plain;
  plain.geodesicSources = 0;
  row.distortion = unfolding::measureDistortion(reference, after.positions, faces, plain);
  const TriangleMesh whole{after.positions, reference.faces};
  const bool flat = flattening::isFlatMap(whole, faces);
  const auto kind = flat ? flattening::DistanceKind::Straight : flattening::DistanceKind::Surface;
  row.local = flattening::distanceError(pairs.local, whole, faces, kind);
  row.all = flattening::distanceError(pairs.all, whole, faces, kind);
  row.turnedOver = flattening::turnedOver(whole, faces);
  const TriangleMesh part = geometry::extractFaces(whole, faces).mesh;
  row.crossings = geometry::findSelfIntersections(part).size();
  row.seen = flattening::seenShare(part);
  return row;
}

/// One row a surface; those before an end was asked for, one at least.
std::vector<Row> measureAll(Context& context, const Settings& s, const TriangleMesh& reference,
                            const std::vector<TriangleMesh>& surfaces,
                            const std::vector<std::int32_t>& faces) {
  auto step = context.step("compare");
  const auto pairs = flattening::drawPairs(reference, faces, s.distances);
  std::vector<Row> rows;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    context.monitor().progress(static_cast<double>(n) / static_cast<double>(surfaces.size()),
                               s.after[n]);
    try {
      rows.push_back(measure(reference, surfaces[n], faces, pairs));
    } catch (const Interrupted&) {
      if (rows.empty()) throw;
      break;
    }
    rows.back().name = std::filesystem::path(s.after[n]).filename().string();
  }
  return rows;
}

std::string tableOf(const std::vector<Row>& rows) {
  std::string text =
      "surface\tarea_error_mean\tarea_error_max\tedge_strain_mean\tedge_strain_p95\t"
      "angle_error_mean_deg\tgeodesic_error_local\tgeodesic_error_all\tscale_local\tscale_all\t"
      "turned_over\tcrossings\tseen\n";
  for (const Row& row : rows) {
    char line[512];
    std::snprintf(line, sizeof line,
                  "%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%lld\t%zu\t%.6g\n",
                  row.distortion.areaErrorMean, row.distortion.areaErrorMax,
                  row.distortion.edgeStrainMean, row.distortion.edgeStrainP95,
                  row.distortion.angleErrorMeanRad * 180 / kPi, row.local.error, row.all.error,
                  row.local.scale, row.all.scale, static_cast<long long>(row.turnedOver),
                  row.crossings, row.seen);
    text += row.name + "\t" + line;
  }
  return text;
}

/// The surface coloured by the logarithm of its area ratio.
void draw(const std::filesystem::path& path, const TriangleMesh& reference,
          const TriangleMesh& after, const std::vector<std::int32_t>& faces, const Row& row) {
  const TriangleMesh whole{after.positions, reference.faces};
  const geometry::SubMesh part = geometry::extractFaces(whole, faces);
  const Eigen::VectorXd means =
      unfolding::vertexMeans(reference, faces, row.distortion.areaRatio, 1);
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
  report::SurfacePictureOptions size;
  size.width = flat ? 900 : 600;
  size.height = flat ? 900 : 500;
  const auto views = flat ? std::vector{above} : std::vector{left, right};
  report::writePng(
      path, report::surfaceFigure(part.mesh, paint, views, static_cast<int>(views.size()), size));
}

nlohmann::ordered_json listOf(const std::vector<Row>& rows) {
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    list.push_back({{"surface", row.name},
                    {"area_error_mean", row.distortion.areaErrorMean},
                    {"edge_strain_mean", row.distortion.edgeStrainMean},
                    {"angle_error_mean_deg", row.distortion.angleErrorMeanRad * 180 / kPi},
                    {"geodesic_error_local", row.local.error},
                    {"geodesic_error_all", row.all.error},
                    {"turned_over", row.turnedOver},
                    {"crossings", row.crossings},
                    {"seen", row.seen}});
  }
  return list;
}

Termination run(Context& context, const Settings& s) {
  const auto begin = std::chrono::steady_clock::now();
  const auto reference = readSurface(context, "BEFORE", s.before, s.reading);
  geometry::requireManifold(reference.mesh, s.before);
  std::vector<TriangleMesh> surfaces;
  std::vector<std::int32_t> faces = everyFace(reference.mesh);
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

  const std::vector<Row> rows = measureAll(context, s, reference.mesh, surfaces, faces);
  const StopScope kept(nullptr);  // what is reached is written
  auto step = context.step("write");
  writeTextFile(context.output("comparison.tsv"), tableOf(rows));
  Termination end =
      rows.size() < surfaces.size() ? Termination::Interrupted : Termination::Finished;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    describing(context, end, [&] {
      draw(context.output("comparison-" + std::to_string(n + 1) + ".png"), reference.mesh,
           surfaces[n], faces, rows[n]);
    });
  }
  const Row& first = rows.front();
  context.result("faces", faces.size());
  context.result("area_error_mean", first.distortion.areaErrorMean);
  context.result("edge_strain_mean", first.distortion.edgeStrainMean);
  context.result("geodesic_error_local", first.local.error);
  context.result("geodesic_error_all", first.all.error);
  context.result("turned_over", static_cast<long long>(first.turnedOver));
  context.result("surfaces", listOf(rows));
  context.result("seconds",
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  return end;
}

}  // namespace

Command compareCommand() {
  return makeCommand<Settings>("compare", declare, run);
}

}  // namespace explica::app
