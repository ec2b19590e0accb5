// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Outputs.h"

#include "Explica/Application/Describing.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Flattening/Selection.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Inflation/Summary.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Visibility/SphereView.h"

#include <algorithm>
#include <iterator>

namespace explica::app {
namespace {

visibility::SphereView lookAt(TriangleMesh mesh, const inflation::InflateOptions& options) {
  geometry::turnOutward(mesh);
  return visibility::lookFromSphere(mesh, visibility::enclosingSphere(mesh, options.viewpoints));
}

void writeVisibility(Context& context, const Inflated& u, const inflation::InflateOptions& options,
                     inflation::InflateSummary& summary) {
  const visibility::SphereView before = lookAt(u.before, options);
  const visibility::SphereView after = lookAt(u.result.mesh, options);
  const auto all = u.before.allFaces();
  const auto means = [&](const TriangleMesh& mesh, const Eigen::VectorXd& values) {
    return unfolding::vertexMeans(mesh, all, values, 0);
  };
  io::writeGiftiShape(context.output("visibility.shape.gii"),
                      {{"visibility before", "", means(u.before, before.share)},
                       {"visibility after", "", means(u.result.mesh, after.share)},
                       {"seen before", "", means(u.before, before.seen)},
                       {"seen after", "", means(u.result.mesh, after.seen)}},
                      u.metadata.structure);
  summary.viewpoints = options.viewpoints;
  summary.target = options.targetSeen;
  summary.visibility = {before.visibility, after.visibility};
  summary.seen = {before.seenShare, after.seenShare};
}

void measureDistances(const Inflated& u, inflation::InflateSummary& summary) {
  const auto all = u.before.allFaces();
  flattening::DistanceOptions options;
  constexpr double kDistanceWork = 3e5;  // vertices visited, about
  options.sources = options.farSources = static_cast<int>(
      std::clamp(kDistanceWork / static_cast<double>(u.before.vertexCount() + 1), 10.0, 20.0));
  const auto pairs = flattening::drawPairs(u.before, all, options);
  const auto along = flattening::DistanceKind::Surface;
  summary.distances = {flattening::distanceError(pairs.local, u.result.mesh, all, along),
                       flattening::distanceError(pairs.all, u.result.mesh, all, along)};
  summary.turnedOver = flattening::turnedOver(u.result.mesh, all);
}

unfolding::Distortion writeDistortion(Context& context, const Inflated& u) {
  const auto all = u.before.allFaces();
  auto d = unfolding::measureDistortion(u.before, u.result.mesh.positions, all);
  const Eigen::VectorXd angleDeg = d.angleErrorRad * (180 / kPi);
  io::writeGiftiShape(
      context.output("distortion.shape.gii"),
      {{"area ratio", "", unfolding::vertexMeans(u.before, all, d.areaRatio, 1)},
       {"angle change", "degrees", unfolding::vertexMeans(u.before, all, angleDeg, 0)},
       {"edge strain", "", unfolding::vertexStrains(u.before, u.result.mesh.positions, all)}},
      u.metadata.structure);
  return d;
}

unfolding::FrameSummary writeFrames(Context& context, const Inflated& u) {
  if (u.result.frames.empty()) return {std::nullopt, std::nullopt};
  std::size_t most = 0;
  std::vector<double> visibilities;
  for (std::size_t n = 0; n < u.result.frames.size(); ++n) {
    const TriangleMesh frame{unfolding::roundedToSingle(u.result.frames[n].positions),
                             u.before.faces};
    most = std::max(most, geometry::findSelfIntersections(frame).size());
    visibilities.push_back(u.result.frames[n].visibility);
    io::writeGiftiSurface(context.output(printed("frames/frame-%04zu.surf.gii", n)), frame,
                          u.metadata);
  }
  return {visibilities, most};
}

/// What is known without another look at the surface.
void describeRun(const Inflated& u, inflation::InflateSummary& s) {
  const inflation::InflateRecord& last = u.result.history.back();
  for (const inflation::InflateRecord& row : u.result.history) s.phases += row.step.phases;
  s.faces = u.before.faceCount();
  s.vertices = u.before.vertexCount();
  s.area = geometry::totalArea(u.before);
  s.volume = {std::abs(geometry::enclosedVolume(u.before)),
              std::abs(geometry::enclosedVolume(u.result.mesh))};
  s.end.iterations = last.step.iteration;
  s.drive = u.result.checkpoint.state.drive;
}

/// What the file holds against what the method promises.
void checkWritten(Context& context, Inflated& u, inflation::InflateSummary& summary) {
  const auto after = geometry::findSelfIntersections(u.result.mesh);
  std::vector<geometry::FacePair> added;
  std::set_difference(after.begin(), after.end(), u.crossings.begin(), u.crossings.end(),
                      std::back_inserter(added));
  summary.crossings = after.size();
  summary.crossingsNew = added.size();
  if (added.empty()) return;
  u.result.flag = unfolding::Flag::Crossing;
  if (reachedGoal(u.result.termination)) u.result.termination = Termination::Stalled;
  context.warn(std::to_string(added.size()) +
               " pairs of faces intersect in what is written that did not at the start");
}

}  // namespace

Termination writeInflated(Context& context, Inflated& u, const inflation::InflateOptions& options) {
  u.metadata.geometricType = "Inflated";
  u.metadata.topologicalType = "Closed";
  u.result.mesh.positions = unfolding::roundedToSingle(u.result.mesh.positions);
  io::writeGiftiSurface(context.output("inflated.surf.gii"), u.result.mesh, u.metadata);
  const bool right = u.metadata.structure == "CortexRight";
  io::writeFreeSurferSurface(context.output(right ? "rh.inflated" : "lh.inflated"), u.result.mesh);
  writeTextFile(context.output("evolution.tsv"), inflation::evolutionTable(u.result.history));
  unfolding::writeCheckpoint(context.output(kInflationState), u.result.checkpoint);
  inflation::InflateSummary summary;
  describing(context, u.result.termination, [&] {
    writeVisibility(context, u, options, summary);
    summary.distortion = writeDistortion(context, u);
    measureDistances(u, summary);
  });
  summary.frames = writeFrames(context, u);
  describeRun(u, summary);
  checkWritten(context, u, summary);
  summary.end.flag = u.result.flag;
  summary.end.stopReason = u.result.termination;
  context.results(summary);
  return u.result.termination;
}

}  // namespace explica::app
