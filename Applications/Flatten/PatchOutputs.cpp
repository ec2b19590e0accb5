// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PatchOutputs.h"

#include "Explica/Application/Describing.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Flattening/PatchTable.h"
#include "Explica/Flattening/Selection.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Pipeline/FlatMarks.h"
#include "Explica/Report/FlatFigure.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Distortion.h"

#include <Eigen/LU>

#include <algorithm>
#include <filesystem>
#include <map>

namespace explica::app {
namespace {

/// Which vertices of the whole FreeSurfer's patch has: one place each, none on a cut, for its faces
/// are all those between its vertices.
std::vector<bool> freeSurferVertices(const flattening::Disc& disc, Eigen::Index vertexCount) {
  const std::vector<bool> second = flattening::secondCopies(disc);
  std::vector<bool> inPatch(static_cast<std::size_t>(vertexCount), false);
  for (const std::int32_t v : disc.vertexOrigin) inPatch[v] = true;
  for (std::size_t v = 0; v < second.size(); ++v) {
    if (second[v]) inPatch[disc.vertexOrigin[v]] = false;
  }
  return inPatch;
}

/// Values of the whole's vertices at the patch's.
template <class Vector>
auto atPatch(const Vector& whole, const flattening::Disc& disc) {
  Vector part(static_cast<Eigen::Index>(disc.vertexOrigin.size()));
  for (std::size_t v = 0; v < disc.vertexOrigin.size(); ++v) {
    part[static_cast<Eigen::Index>(v)] = whole[disc.vertexOrigin[v]];
  }
  return part;
}

/// Values of the patch's vertices on the whole's; where a vertex has copies, their mean.
Eigen::VectorXd onWhole(const Eigen::VectorXd& part, const flattening::Disc& disc,
                        Eigen::Index vertexCount, double elsewhere) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(vertexCount), count = sum;
  for (std::size_t v = 0; v < disc.vertexOrigin.size(); ++v) {
    sum[disc.vertexOrigin[v]] += part[static_cast<Eigen::Index>(v)];
    count[disc.vertexOrigin[v]] += 1;
  }
  return (count.array() > 0).select(sum.cwiseQuotient(count), elsewhere);
}

/// FreeSurfer's files name their maps with the folder they came from; frames of `explica sample` go
/// without their volume.
std::string mapName(const std::string& file, const std::string& name) {
  const std::string own = std::filesystem::path(name.empty() ? file : name).filename().string();
  std::string stem = std::filesystem::path(file).filename().string();
  constexpr std::string_view kSampled = ".func.gii";
  if (name.empty() || !stem.ends_with(kSampled)) return own;
  stem.resize(stem.size() - kSampled.size());
  return own.starts_with(stem + " ") ? own : stem + " " + own;
}

/// Maps on the patch's vertices, and how the first colours the picture.
std::vector<flattening::PatchMap> mapsOnPatch(const FlattenSettings& s,
                                              const flattening::Disc& disc, Eigen::Index whole,
                                              report::SurfacePaint& paint) {
  std::vector<flattening::PatchMap> maps;
  for (const std::string& path : s.maps) {
    for (const io::VertexMap& read : io::readVertexMaps(path, whole)) {
      maps.push_back({mapName(path, read.name), atPatch(read.values, disc)});
      if (maps.size() == 1) {
        paint.values = maps[0].values;
        paint.scale = report::scaleFor(paint.values, maps[0].name, read.unit);
      }
    }
  }
  return maps;
}

/// Regions on the patch's vertices: only those that it has are left.
std::vector<io::LabelMap> regionsOnPatch(const FlattenSettings& s, const flattening::Disc& disc,
                                         Eigen::Index whole) {
  std::vector<io::LabelMap> regions = io::readRegions({s.regions.begin(), s.regions.end()}, whole);
  for (io::LabelMap& one : regions) {
    one.keys = atPatch(one.keys, disc);
    std::erase_if(one.table, [&](const io::LabelEntry& entry) {
      return std::find(one.keys.begin(), one.keys.end(), entry.key) == one.keys.end();
    });
  }
  return regions;
}

void writeRegions(Context& context, io::LabelMap regions, const std::string& structure) {
  const bool zeroIsRegion = std::any_of(regions.table.begin(), regions.table.end(),
                                        [](const io::LabelEntry& e) { return e.key == 0; });
  const Label none = zeroIsRegion ? -1 : 0;
  for (Label& key : regions.keys) key = key == io::kNoRegion ? none : key;
  regions.table.insert(regions.table.begin(), {none, "???", {0, 0, 0, 0}});
  io::writeGiftiLabel(context.output("patch_" + regions.name + ".label.gii"), regions, structure);
}

}  // namespace

TriangleMesh wholeMap(const TriangleMesh& reference, const flattening::Disc& disc,
                      const flattening::FlatPositions& map) {
  const std::vector<bool> second = flattening::secondCopies(disc);
  TriangleMesh flat{Positions::Zero(reference.vertexCount(), 3), Faces(disc.mesh.faceCount(), 3)};
  for (std::size_t v = 0; v < disc.vertexOrigin.size(); ++v) {
    if (second[v]) continue;
    flat.positions.row(disc.vertexOrigin[v]).head<2>() = map.row(static_cast<Eigen::Index>(v));
  }
  Eigen::Index kept = 0;
  for (std::size_t f = 0; f < disc.faceOrigin.size(); ++f) {
    const auto corners = disc.mesh.faces.row(static_cast<Eigen::Index>(f));
    if (second[corners[0]] || second[corners[1]] || second[corners[2]]) continue;
    flat.faces.row(kept++) = reference.faces.row(disc.faceOrigin[f]);
  }
  flat.faces.conservativeResize(kept, 3);
  return flat;
}

Positions patchPositions(const flattening::FlatMap& map) {
  Positions flat = Positions::Zero(map.positions.rows(), 3);
  flat.leftCols<2>() = map.positions;
  return flat;
}

void writeSurfaces(Context& context, const Subject& subject, const flattening::Disc& disc,
                   const flattening::FlatMap& map, const TriangleMesh& flat) {
  io::SurfaceMetadata metadata = subject.reference.metadata;
  metadata.topologicalType = "Open";
  io::writeGiftiSurface(context.output("patch.surf.gii"), disc.mesh, metadata);
  metadata.geometricType = "Flat";
  metadata.secondary.clear();
  metadata.name = "flat";
  io::writeGiftiSurface(context.output("flat.surf.gii"), flat, metadata);
  const Positions positions = patchPositions(map);
  io::writeGiftiSurface(context.output("patch_flat.surf.gii"), {positions, disc.mesh.faces},
                        metadata);
  Eigen::VectorXd numbers(disc.mesh.vertexCount());
  std::copy(disc.vertexOrigin.begin(), disc.vertexOrigin.end(), numbers.begin());
  io::writeGiftiShape(context.output("vertex_of.shape.gii"), {{"vertex", "", numbers}},
                      metadata.structure);
  const std::string side = metadata.structure == "CortexRight" ? "rh" : "lh";
  TriangleMesh whole = subject.reference.mesh;
  if (subject.reference.origin.format == "FreeSurfer") {  // patches hold surface RAS as stored
    const Eigen::Matrix4d back = subject.reference.origin.applied.inverse();
    whole.positions = ((whole.positions * back.topLeftCorner<3, 3>().transpose()).rowwise() +
                       back.topRightCorner<3, 1>().transpose())
                          .eval();
  }
  io::Patch patch = io::patchOf(whole, freeSurferVertices(disc, flat.vertexCount()));
  io::writePatch(context.output(side + ".patch.3d"), patch);
  patch.positions = flat.positions(patch.vertices, Eigen::all);
  io::writePatch(context.output(side + ".patch.flat"), patch);
}

Eigen::VectorXd measure(Context& context, const Subject& subject, const flattening::Disc& disc,
                        const TriangleMesh& flat, unfolding::FlatSummary& summary,
                        Termination& termination) {
  const TriangleMesh& before = disc.mesh;
  const auto all = flat.allFaces();
  const auto distortion = unfolding::measureDistortion(before, flat.positions, all);
  const Eigen::VectorXd angleDeg = distortion.angleErrorRad * (180 / kPi);
  const Eigen::VectorXd ratio = unfolding::vertexMeans(before, all, distortion.areaRatio, 1);
  const auto whole = [&](const Eigen::VectorXd& part, double elsewhere) {
    return onWhole(part, disc, subject.reference.mesh.vertexCount(), elsewhere);
  };
  io::writeGiftiShape(
      context.output("distortion.shape.gii"),
      {{"area ratio", "", whole(ratio, 1)},
       {"angle change", "degrees", whole(unfolding::vertexMeans(before, all, angleDeg, 0), 0)},
       {"edge strain", "", whole(unfolding::vertexStrains(before, flat.positions, all), 0)}},
      subject.reference.metadata.structure);
  constexpr double kDistanceWork = 2e6;  // vertices visited, about
  flattening::DistanceOptions options{
      .farSources = static_cast<int>(
          std::clamp(kDistanceWork / static_cast<double>(flat.faceCount() / 2 + 1), 20.0, 100.0))};
  describing(context, termination, [&] {
    const auto pairs = flattening::drawPairs(before, all, options);
    const auto straight = flattening::DistanceKind::Straight;
    summary.distances = {flattening::distanceError(pairs.local, flat, all, straight),
                         flattening::distanceError(pairs.all, flat, all, straight)};
  });
  summary.distortion = distortion;
  return ratio;
}

void writePatchTable(Context& context, const FlattenSettings& s, const Subject& subject,
                     const flattening::Disc& disc, const flattening::FlatMap& map,
                     const Eigen::VectorXd& areaRatio) {
  report::SurfacePaint paint;
  const Eigen::Index whole = subject.reference.mesh.vertexCount();
  const auto maps = mapsOnPatch(s, disc, whole, paint);
  paint.folding = atPatch(maps::meanCurvature(subject.reference.mesh), disc);
  if (maps.empty() && s.regions.empty()) {
    paint.values = areaRatio.cwiseMax(1e-6).array().log2();
    paint.scale = {report::ColourMap::Diverging, -0.5, 0.5, "area, doublings", ""};
  }
  const TriangleMesh flat{patchPositions(map), disc.mesh.faces};
  std::vector<flattening::PatchRegions> rows;
  report::FlatMarks marks;
  pipeline::markDirections(disc.mesh.positions, flat, marks);
  for (const io::LabelMap& regions : regionsOnPatch(s, disc, whole)) {
    flattening::PatchRegions& row = rows.emplace_back();
    row.keys = regions.keys;
    for (const io::LabelEntry& entry : regions.table) row.names[entry.key] = entry.name;
    pipeline::markRegions(regions, flat, marks);
    writeRegions(context, regions, subject.reference.metadata.structure);
  }
  writeTextFile(context.output("patch.tsv"),
                flattening::patchTable(disc.mesh, flat.positions, rows, maps));
  report::writePng(context.output("flat.png"), report::flatFigure(flat, paint, marks));
}

std::optional<std::int64_t> writeFrames(Context& context, const Subject& subject,
                                        const flattening::Disc& disc,
                                        const std::vector<flattening::FlatPositions>& frames) {
  if (frames.empty()) return {};
  io::SurfaceMetadata metadata = subject.reference.metadata;
  metadata.topologicalType = "Open";
  metadata.geometricType = "Flat";
  metadata.secondary.clear();
  std::int64_t turnedOver = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    turnedOver = std::max(turnedOver, flattening::countTurnedOver(disc.mesh.faces, frames[n]));
    io::writeGiftiSurface(context.output(printed("frames/frame-%04zu.surf.gii", n)),
                          wholeMap(subject.reference.mesh, disc, frames[n]), metadata);
  }
  return turnedOver;
}

}  // namespace explica::app
