// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Report/Evolution.h"
#include "ReportParts.h"

#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

/// A patch and the shapes in which it is shown.
struct FlatPatch {
  std::vector<std::int32_t> vertices;    ///< of the whole surface
  TriangleMesh reference;                ///< the whole surface where areas and lengths count
  std::optional<TriangleMesh> unfolded;  ///< as it was given, if it is another shape than that
  TriangleMesh flat;                     ///< the patch alone
  std::string side;
};

std::vector<std::int32_t> patchVertices(const StepFolder& step) {
  const std::vector<io::VertexMap> maps = io::readVertexMaps(step.folder / "vertex_of.shape.gii");
  std::vector<std::int32_t> vertices;
  for (const double v : maps.front().values) vertices.push_back(static_cast<std::int32_t>(v));
  return vertices;
}

std::optional<FlatPatch> readPatch(const StepFolder& step) {
  FlatPatch patch;
  patch.vertices = patchVertices(step);
  patch.flat = io::readSurface(step.folder / "patch_flat.surf.gii").mesh;
  const auto given = inputOf(step, "SURFACE"), reference = inputOf(step, "reference");
  if (!given || !isThere(*given)) return {};
  io::LoadedSurface surface = io::readSurface(*given);
  patch.side = surface.metadata.structure == "CortexRight" ? "right" : "left";
  if (reference && isThere(*reference)) {
    patch.unfolded = std::move(surface.mesh);
    patch.reference = io::readSurface(*reference).mesh;
  } else {
    patch.reference = std::move(surface.mesh);
  }
  const Eigen::Index count = patch.reference.vertexCount();
  const bool fits =
      patch.flat.vertexCount() == static_cast<Eigen::Index>(patch.vertices.size()) &&
      std::ranges::all_of(patch.vertices, [&](std::int32_t v) { return v >= 0 && v < count; });
  if (!fits || (patch.unfolded && patch.unfolded->vertexCount() != count)) return {};
  return patch;
}

/// From where the patch is looked at: against its mean normal.
Vector sightOf(const FlatPatch& patch) {
  Vector normal = Vector::Zero();
  for (Eigen::Index f = 0; f < patch.flat.faceCount(); ++f) {
    const auto corner = [&](int k) -> Point {
      return patch.reference.positions.row(patch.vertices[patch.flat.faces(f, k)]).transpose();
    };
    normal += (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  return normal.norm() > 0 ? Vector(-normal.normalized()) : Vector(1, 0, 0);
}

/// The patch's vertices of a whole surface.
Positions positionsOf(const FlatPatch& patch, const TriangleMesh& whole) {
  return whole.positions(patch.vertices, Eigen::all);
}

/// The flat map where the patch is, facing the one who looks along `sight`.
Positions flatInPlace(const FlatPatch& patch, const Vector& sight) {
  const Vector up = std::abs(sight.z()) > 0.9 ? Vector(0, 1, 0) : Vector(0, 0, 1);
  const Vector right = sight.cross(up).normalized();
  Eigen::Matrix<double, 2, 3> axes;
  axes << right.transpose(), right.cross(sight).transpose();
  const Positions folded = positionsOf(patch, patch.reference);
  const Eigen::RowVector2d middle = patch.flat.positions.leftCols(2).colwise().mean();
  Positions placed = (patch.flat.positions.leftCols(2).rowwise() - middle) * axes;
  placed.rowwise() += folded.colwise().mean();
  return placed;
}

/// The maps that the command was given, and the reader's.
std::vector<GivenMap> mapsOf(ResultFolder& results, const StepFolder& step,
                             const std::vector<GivenMap>& given) {
  std::vector<std::string> files;
  for (const fs::path& file : inputsOf(step, "map")) files.push_back(file.string());
  std::vector<GivenMap> maps = readGivenMaps(results, files);
  for (const GivenMap& map : given) {
    const bool known =
        std::ranges::any_of(maps, [&](const GivenMap& m) { return m.name == map.name; });
    if (!known) maps.push_back(map);
  }
  return maps;
}

void showShapes(ResultFolder& results, const StepFolder& step, const std::vector<GivenMap>& given) {
  const auto patch = readPatch(step);
  if (!patch) return;
  std::vector<GivenMap> maps = mapsOf(results, step, given);
  const Eigen::Index count = patch->reference.vertexCount();
  std::erase_if(maps, [&](const GivenMap& m) { return !m.fits(count, patch->side); });
  if (maps.empty()) {
    const auto strain = mapNamed(step.folder / "distortion.shape.gii", count, "edge strain");
    if (strain) maps.push_back({"edge strain of the flat map", "", "", strain->values});
  }
  report::Evolution evolution;
  evolution.title = "patch";
  evolution.mesh = {positionsOf(*patch, patch->reference), patch->flat.faces};
  evolution.shapes = {{"on the surface", {}}};
  if (patch->unfolded) {
    evolution.shapes.push_back({"unfolded", positionsOf(*patch, *patch->unfolded)});
  }
  const Vector sight = sightOf(*patch);
  evolution.shapes.push_back({"flat", flatInPlace(*patch, sight)});
  evolution.region.resize(patch->vertices.size());
  std::iota(evolution.region.begin(), evolution.region.end(), 0);
  evolution.viewpoint = evolution.mesh.positions.colwise().mean().transpose() - 1e5 * sight;
  for (const GivenMap& map : maps) {
    const Eigen::VectorXd part = map.values(patch->vertices);
    evolution.maps.push_back({part, report::scaleFor(part, map.name, map.unit)});
  }
  results.content().evolutions.push_back(std::move(evolution));
}

void showPicture(ResultFolder& results, const StepFolder& step) {
  const std::filesystem::path file = step.folder / "flat.png";
  if (!isThere(file)) return;
  const bool outlined = std::ranges::any_of(filesOf(step, ".label.gii"), [](const fs::path& one) {
    return one.filename().string().starts_with("patch_");
  });
  results.content().drawings.push_back(
      {kFlatPlace, "The flat map",
       std::string("Sulci are darker than gyri. ") +
           (outlined ? "Regions are outlined in their own colours. " : "") +
           "The scale bar holds everywhere up to the area error.",
       "image/png", fileText(file)});
}

/// The states on the way, looked at from above.
void playFrames(ResultFolder& results, const StepFolder& step) {
  const ShownFrames frames = framesOf(step);
  if (frames.meshes.size() < 2) return;
  report::Evolution evolution = report::evolutionOf(frames.meshes);
  evolution.frameTitles = frames.titles;
  addMaps(evolution, step.folder / "distortion.shape.gii");
  evolution.viewpoint = Point(0, 0, 1e5);
  for (std::int32_t v : evolution.mesh.faces.reshaped()) evolution.region.push_back(v);
  std::ranges::sort(evolution.region);
  evolution.region.erase(std::unique(evolution.region.begin(), evolution.region.end()),
                         evolution.region.end());
  evolution.title = "the way to the flat map";
  results.content().evolutions.push_back(std::move(evolution));
}

}  // namespace

void showFlat(ResultFolder& results, const StepFolder& step, const std::vector<GivenMap>& maps) {
  results.attempt("Picture of the flat map", [&] { showPicture(results, step); });
  results.attempt("The way to the map", [&] { playFrames(results, step); });
  results.attempt("The patch's shapes", [&] { showShapes(results, step, maps); });
  showFlatStacks(results, step);
  results.attempt("Distortion maps", [&] {
    chartMaps(results, step, "distortion.shape.gii", kDistortionPlace, patchVertices(step));
  });
  results.attempt("Regions of the patch", [&] {
    tabulate(results, readTable(step.folder / "patch.tsv"), "Regions of the patch",
             "Areas in mm\u00b2; means and standard deviations of the maps are weighted by the "
             "vertices' areas.");
  });
}

}  // namespace explica::pipeline
