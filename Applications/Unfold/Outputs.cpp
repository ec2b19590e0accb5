// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Outputs.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VtkFile.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Crossings.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Unfolding/Summary.h"
#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/FluxVariance.h"

#include <algorithm>
#include <functional>

namespace explica::app {
namespace {

/// What is measured on the surface as it is written.
struct Measures {
  TriangleMesh reference;  ///< before, with the faces that are written
  unfolding::Distortion distortion;
  visibility::VisibleFraction seenAfter;
  Eigen::VectorXd areaRatio;        ///< of every face that is written; 1 where nothing moves
  Eigen::VectorXd angleChange;      ///< degrees; 0 outside the region
  std::vector<std::int32_t> moved;  ///< faces: the region's and the collar's, ascending
};

Measures measure(const Unfolded& u) {
  const TriangleMesh& after = u.result.mesh;
  const auto& faces = u.result.region.faces;
  Measures m;
  m.reference = {u.before.positions, after.faces};
  m.distortion = unfolding::measureDistortion(m.reference, after.positions, faces);
  m.seenAfter =
      after.faceCount() == u.before.faceCount()
          ? visibility::visibleFractionAfter(after, u.view, u.before.positions, u.seenBefore)
          : visibility::visibleFraction(after, u.view);
  m.moved = faces;
  m.moved.insert(m.moved.end(), u.result.collar.begin(), u.result.collar.end());
  std::sort(m.moved.begin(), m.moved.end());
  const Eigen::VectorXd areas0 = geometry::faceAreas(m.reference);
  const Eigen::VectorXd areas1 = geometry::faceAreas(after);
  m.areaRatio = Eigen::VectorXd::Ones(after.faceCount());
  m.angleChange = Eigen::VectorXd::Zero(after.faceCount());
  for (const std::int32_t f : m.moved) {
    if (areas0[f] > 0) m.areaRatio[f] = areas1[f] / areas0[f];
  }
  for (std::size_t n = 0; n < faces.size(); ++n) {
    m.angleChange[faces[n]] =
        m.distortion.angleErrorRad[static_cast<Eigen::Index>(n)] * (180 / kPi);
  }
  return m;
}

io::LabelMap regionLabel(const Unfolded& u) {
  io::LabelMap label{
      "region",
      {},
      {{0, "surroundings", {0.7F, 0.7F, 0.7F, 1}}, {1, "region", {0.3F, 0.5F, 0.9F, 1}}}};
  label.keys.setZero(u.before.vertexCount());
  for (const std::int32_t v : u.result.region.vertices) label.keys[v] = 1;
  return label;
}

/// Surfaces and maps, some of them at the same time.
void writeFiles(Context& context, const Unfolded& u, const Measures& m) {
  const TriangleMesh& after = u.result.mesh;
  const auto& faces = u.result.region.faces;
  const std::string structure = u.metadata.structure;
  const std::vector<io::VertexMap> visibilityMaps = {
      {"flux before", "", visibility::vertexFlux(u.before, u.view)},
      {"flux after", "", visibility::vertexFlux(after, u.view)},
      {"seen before", "", u.seenBefore.vertex},
      {"seen after", "", m.seenAfter.vertex}};
  const Eigen::VectorXd movedRatio = m.areaRatio(m.moved);
  const Eigen::VectorXd angles = m.angleChange(faces);
  const std::vector<io::VertexMap> distortionMaps = {
      {"area ratio", "", unfolding::vertexMeans(m.reference, m.moved, movedRatio, 1)},
      {"angle change", "degrees", unfolding::vertexMeans(m.reference, faces, angles, 0)},
      {"edge strain", "", unfolding::vertexStrains(m.reference, after.positions, faces)}};
  const io::LabelMap label = regionLabel(u);

  std::vector<io::VertexMap> allVertexMaps = visibilityMaps;
  allVertexMaps.insert(allVertexMaps.end(), distortionMaps.begin(), distortionMaps.end());
  allVertexMaps.push_back({"region", "", label.keys.cast<double>()});
  Eigen::VectorXd faceSeenBefore = u.seenBefore.face;
  if (after.faceCount() != u.before.faceCount()) {  // the region alone
    faceSeenBefore.resize(after.faceCount());
    for (std::size_t n = 0; n < faces.size(); ++n) {
      faceSeenBefore[faces[n]] = u.seenBefore.face[u.chosen.faces[n]];
    }
  }
  std::vector<std::function<void()>> files;
  const auto write = [&](const char* name, auto writing) {
    files.emplace_back([writing, path = context.output(name)] { writing(path); });
  };
  write("unfolded.surf.gii",
        [&](const auto& path) { io::writeGiftiSurface(path, after, u.metadata); });
  if (u.reference == kReferenceFile) {
    write(kReferenceFile,
          [&](const auto& path) { io::writeGiftiSurface(path, u.before, u.metadata); });
  }
  write("visibility.shape.gii",
        [&](const auto& path) { io::writeGiftiShape(path, visibilityMaps, structure); });
  write("distortion.shape.gii",
        [&](const auto& path) { io::writeGiftiShape(path, distortionMaps, structure); });
  write("region.label.gii", [&](const auto& path) { io::writeGiftiLabel(path, label, structure); });
  write("unfolded.vtp", [&](const auto& path) {
    io::writeVtp(path, after, allVertexMaps,
                 {{"area ratio", "", m.areaRatio},
                  {"angle change", "degrees", m.angleChange},
                  {"seen before", "", faceSeenBefore},
                  {"seen after", "", m.seenAfter.face}});
  });
  write("evolution.tsv", [&](const auto& path) {
    writeTextFile(path, unfolding::evolutionTable(u.result.history));
  });
  write(kUnfoldingState,
        [&](const auto& path) { unfolding::writeCheckpoint(path, u.result.checkpoint); });
  parallelFor(files.size(), 1, [&](std::size_t n) { files[n](); });
}

/// @param before  pairs that cross at the start, among the faces that are written
unfolding::FrameSummary writeFrames(Context& context, const Unfolded& u, const Measures& m,
                                    const std::vector<geometry::FacePair>& before) {
  if (u.result.frames.empty()) return {std::nullopt, std::nullopt};
  std::vector<bool> moved(static_cast<std::size_t>(u.result.mesh.faceCount()), false);
  for (const std::int32_t f : m.moved) moved[f] = true;
  std::size_t most = 0;
  std::vector<double> visibilities;
  for (std::size_t n = 0; n < u.result.frames.size(); ++n) {
    const TriangleMesh frame{unfolding::roundedToSingle(u.result.frames[n].positions),
                             u.result.mesh.faces};
    most = std::max(most, geometry::findSelfIntersections(frame, moved, before).size());
    visibilities.push_back(u.result.frames[n].visibility);
    io::writeGiftiSurface(context.output(printed("frames/frame-%04zu.surf.gii", n)), frame,
                          u.metadata);
  }
  return {visibilities, most};
}

/// The unfolding in numbers, but for frames, crossings and end.
unfolding::UnfoldSummary summaryOf(const Unfolded& u, const Measures& m) {
  const TriangleMesh& after = u.result.mesh;
  const unfolding::Region& region = u.result.region;
  const auto& faces = region.faces;
  const auto visibilityOf = [&](const TriangleMesh& mesh) {
    return visibility::AverageVisibility(mesh.faces, faces, u.view).value(mesh.positions);
  };
  unfolding::UnfoldSummary s;
  s.reference = u.reference;
  s.surround = u.surround;
  s.view = u.view;
  s.target = u.goal;
  s.regionFaces = faces.size();
  s.regionVertices = region.vertices.size();
  s.regionPieces = region.pieces;
  s.regionHoles = region.holes;
  s.regionArea = geometry::totalArea(geometry::extractFaces(m.reference, faces).mesh);
  s.visibility = {visibilityOf(m.reference), visibilityOf(after)};
  s.fluxVariance = {visibility::fluxVariance(m.reference, faces, u.view),
                    visibility::fluxVariance(after, faces, u.view)};
  s.seen = {u.seenBefore.of(u.before, u.chosen.faces), m.seenAfter.of(after, faces)};
  s.realVisibility = {u.seenBefore.realOf(u.before, u.chosen.faces),
                      m.seenAfter.realOf(after, faces)};
  s.backfacing = {unfolding::backfacingShare(m.reference, faces, u.view),
                  unfolding::backfacingShare(after, faces, u.view)};
  s.distortion = m.distortion;
  const auto& collar = u.result.collar;
  s.collarFaces = collar.size();
  s.collarStretchMean = s.collarStretchMax = std::nullopt;
  if (!collar.empty()) {
    const Eigen::VectorXd stretch = m.areaRatio(collar);
    s.collarStretchMean = stretch.mean();
    s.collarStretchMax = stretch.maxCoeff();
  }
  const auto& last = u.result.history.back();
  for (const unfolding::IterationRecord& row : u.result.history) s.phases += row.phases;
  s.iterationWritten = u.result.iteration;
  s.secondsPerIteration = last.iteration > 0 ? last.seconds / last.iteration : 0;
  s.end.iterations = last.iteration;
  return s;
}

/// What the surroundings had to give for the region to be seen.
void sayCollar(Context& context, const Unfolded& u, const Measures& m) {
  const auto& collar = u.result.collar;
  if (collar.empty()) return;
  const Eigen::VectorXd stretch = m.areaRatio(collar);
  if (stretch.maxCoeff() <= unfolding::kCollarMost) return;
  context.warn(
      printed("%lld of %zu faces around the region are stretched to more than %g times their area, "
              "one to %.1f times; %.2f times in the mean%s",
              static_cast<long long>((stretch.array() > unfolding::kCollarMost).count()),
              collar.size(), unfolding::kCollarMost, stretch.maxCoeff(), stretch.mean(),
              u.surround == unfolding::Surround::Elastic
                  ? ""
                  : ": with --surround elastic more of them follow, and stretch less"));
}

/// What the file holds against what the method promises.
void checkWritten(Context& context, Unfolded& u, const unfolding::CrossingAccount& crossings) {
  if (crossings.added == 0) return;
  u.result.flag = unfolding::Flag::Crossing;
  if (reachedGoal(u.result.termination)) u.result.termination = Termination::Stalled;
  context.warn(std::to_string(crossings.added) +
               " pairs of faces intersect in what is written that did not at the start");
}

}  // namespace

Termination writeUnfolded(Context& context, Unfolded& u) {
  u.metadata.topologicalType.clear();
  u.result.mesh.positions = unfolding::roundedToSingle(u.result.mesh.positions);
  const Measures m = measure(u);
  const auto crossings = unfolding::countCrossings(u.before, u.chosen, u.result, u.crossings);
  writeFiles(context, u, m);
  const bool whole = u.result.mesh.faceCount() == u.before.faceCount();
  unfolding::UnfoldSummary summary = summaryOf(u, m);
  summary.frames =
      writeFrames(context, u, m, whole ? u.crossings : std::vector<geometry::FacePair>{});
  summary.crossings = crossings.after.size();
  summary.crossingsNew = crossings.added;
  summary.crossingsWithRest = crossings.withRest;
  sayCollar(context, u, m);
  checkWritten(context, u, crossings);
  summary.end.flag = u.result.flag;
  summary.end.stopReason = u.result.termination;
  context.results(summary);
  return u.result.termination;
}

}  // namespace explica::app
