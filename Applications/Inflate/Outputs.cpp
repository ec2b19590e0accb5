// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Outputs.h"

#include "Explica/Application/Describing.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Visibility/GlobalMeasures.h"
#include "Explica/Visibility/SphereView.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <numeric>

namespace explica::app {
namespace {

constexpr double kDistanceWork = 3e5;  // vertices visited for the distance errors, about

std::vector<std::int32_t> everyFace(const TriangleMesh& mesh) {
  std::vector<std::int32_t> all(static_cast<std::size_t>(mesh.faceCount()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

visibility::SphereView lookAt(TriangleMesh mesh, const inflation::InflateOptions& options) {
  if (geometry::enclosedVolume(mesh) < 0) mesh.faces.col(1).swap(mesh.faces.col(2));
  return visibility::lookFromSphere(mesh, visibility::enclosingSphere(mesh, options.viewpoints));
}

void writeVisibility(Context& context, const Inflated& u,
                     const inflation::InflateOptions& options) {
  const visibility::SphereView before = lookAt(u.before, options);
  const visibility::SphereView after = lookAt(u.result.mesh, options);
  const auto all = everyFace(u.before);
  const auto means = [&](const TriangleMesh& mesh, const Eigen::VectorXd& values) {
    return unfolding::vertexMeans(mesh, all, values, 0);
  };
  io::writeGiftiShape(context.output("visibility.shape.gii"),
                      {{"visibility before", "", means(u.before, before.share)},
                       {"visibility after", "", means(u.result.mesh, after.share)},
                       {"seen before", "", means(u.before, before.seen)},
                       {"seen after", "", means(u.result.mesh, after.seen)}},
                      u.metadata.structure);
  context.result("viewpoints", options.viewpoints);
  context.result("visibility_initial", before.visibility);
  context.result("visibility_final", after.visibility);
  context.result("seen_initial", before.seenShare);
  context.result("seen_final", after.seenShare);
}

/// The thesis's own global measures (4.6) and (4.7), before and after; a sphere for both.
void reportGlobalMeasures(Context& context, const Inflated& u) {
  constexpr double kAway = 10;  // of the farthest vertex: the radius of the viewing sphere
  const auto outward = [](TriangleMesh mesh) {
    if (geometry::enclosedVolume(mesh) < 0) mesh.faces.col(1).swap(mesh.faces.col(2));
    return mesh;
  };
  const TriangleMesh before = outward(u.before), after = outward(u.result.mesh);
  const Point centre = before.positions.colwise().mean();
  double farthest = 0;
  for (const TriangleMesh* mesh : {&before, &after}) {
    farthest = std::max(
        farthest, (mesh->positions.rowwise() - centre.transpose()).rowwise().norm().maxCoeff());
  }
  const double radius = kAway * farthest;
  context.result("viewing_radius", radius);
  context.result("hidden_viewing_area_initial",
                 visibility::hiddenViewingArea(before, centre, radius));
  context.result("hidden_viewing_area_final", visibility::hiddenViewingArea(after, centre, radius));
  context.result("self_occlusion_initial", visibility::selfOcclusion(before));
  context.result("self_occlusion_final", visibility::selfOcclusion(after));
}

void reportDistances(Context& context, const Inflated& u) {
  const auto all = everyFace(u.before);
  flattening::DistanceOptions options;
  options.sources = options.farSources = static_cast<int>(
      std::clamp(kDistanceWork / static_cast<double>(u.before.vertexCount() + 1), 10.0, 20.0));
  const auto pairs = flattening::drawPairs(u.before, all, options);
  const auto along = flattening::DistanceKind::Surface;
  context.result("geodesic_error_local",
                 flattening::distanceError(pairs.local, u.result.mesh, all, along).error);
  context.result("geodesic_error_all",
                 flattening::distanceError(pairs.all, u.result.mesh, all, along).error);
  context.result("turned_over", static_cast<long long>(flattening::turnedOver(u.result.mesh, all)));
}

void writeDistortion(Context& context, const Inflated& u) {
  const auto all = everyFace(u.before);
  unfolding::DistortionOptions plain;
  plain.geodesicSources = 0;
  const auto d = unfolding::measureDistortion(u.before, u.result.mesh.positions, all, plain);
  const Eigen::VectorXd angleDeg = d.angleErrorRad * (180 / kPi);
  io::writeGiftiShape(
      context.output("distortion.shape.gii"),
      {{"area ratio", "", unfolding::vertexMeans(u.before, all, d.areaRatio, 1)},
       {"angle change", "degrees", unfolding::vertexMeans(u.before, all, angleDeg, 0)},
       {"edge strain", "", unfolding::vertexStrains(u.before, u.result.mesh.positions, all)}},
      u.metadata.structure);
  context.result("area_error_mean", d.areaErrorMean);
  context.result("area_error_max", d.areaErrorMax);
  context.result("angle_error_mean_deg", d.angleErrorMeanRad * 180 / kPi);
  context.result("edge_strain_mean", d.edgeStrainMean);
  context.result("edge_strain_p95", d.edgeStrainP95);
}

void writeFrames(Context& context, const Inflated& u) {
  if (u.result.frames.empty()) return;
  std::size_t most = 0;
  std::vector<double> visibilities;
  for (std::size_t n = 0; n < u.result.frames.size(); ++n) {
    const TriangleMesh frame{unfolding::roundedToSingle(u.result.frames[n].positions),
                             u.before.faces};
    most = std::max(most, geometry::findSelfIntersections(frame).size());
    visibilities.push_back(u.result.frames[n].visibility);
    char name[64];
    std::snprintf(name, sizeof name, "frames/frame-%04zu.surf.gii", n);
    io::writeGiftiSurface(context.output(name), frame, u.metadata);
  }
  context.result("frame_visibilities", visibilities);
  context.result("self_intersections_frames_max", most);
}

void reportRun(Context& context, const Inflated& u) {
  const inflation::InflateRecord& last = u.result.history.back();
  unfolding::PhaseSeconds phases;
  for (const inflation::InflateRecord& row : u.result.history) phases += row.step.phases;
  context.result("faces", u.before.faceCount());
  context.result("vertices", u.before.vertexCount());
  context.result("area", geometry::totalArea(u.before));
  context.result("volume_initial", std::abs(geometry::enclosedVolume(u.before)));
  context.result("volume_final", std::abs(geometry::enclosedVolume(u.result.mesh)));
  context.result("iterations", last.step.iteration);
  context.result("drive", u.result.checkpoint.state.drive);
  context.result("seconds_collision", phases.collision);
  context.result("seconds_solve", phases.solve);
}

/// What the file holds against what the method promises.
void checkWritten(Context& context, Inflated& u) {
  const auto after = geometry::findSelfIntersections(u.result.mesh);
  std::vector<geometry::FacePair> added;
  std::set_difference(after.begin(), after.end(), u.crossings.begin(), u.crossings.end(),
                      std::back_inserter(added));
  context.result("self_intersections_final", after.size());
  context.result("self_intersections_new", added.size());
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
  describing(context, u.result.termination, [&] {
    writeVisibility(context, u, options);
    if (u.globalMeasures) reportGlobalMeasures(context, u);
    writeDistortion(context, u);
    reportDistances(context, u);
  });
  writeFrames(context, u);
  reportRun(context, u);
  checkWritten(context, u);
  context.result("flag", std::string(nameOf(u.result.flag)));
  context.result("stop_reason", std::string(nameOf(u.result.termination)));
  return u.result.termination;
}

}  // namespace explica::app
