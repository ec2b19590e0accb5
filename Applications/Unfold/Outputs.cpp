// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Outputs.h"

#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VtkFile.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Crossings.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/FluxVariance.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace explica::app {
namespace {

/// What is measured on the surface as it is written.
struct Measures {
  TriangleMesh reference;  ///< before, with the faces that are written
  unfolding::Distortion distortion;
  visibility::VisibleFraction seenBefore, seenAfter;
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
  m.seenBefore = visibility::visibleFraction(u.before, u.view);
  m.seenAfter = visibility::visibleFraction(after, u.view);
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

/// Surfaces and maps.
void writeFiles(Context& context, const Unfolded& u, const Measures& m) {
  const TriangleMesh& after = u.result.mesh;
  const auto& faces = u.result.region.faces;
  const std::string structure = u.metadata.structure;
  io::writeGiftiSurface(context.output("unfolded.surf.gii"), after, u.metadata);

  const std::vector<io::VertexMap> visibilityMaps = {
      {"flux before", "", visibility::vertexFlux(u.before, u.view)},
      {"flux after", "", visibility::vertexFlux(after, u.view)},
      {"seen before", "", m.seenBefore.vertex},
      {"seen after", "", m.seenAfter.vertex}};
  io::writeGiftiShape(context.output("visibility.shape.gii"), visibilityMaps, structure);
  const Eigen::VectorXd movedRatio = m.areaRatio(m.moved);
  const Eigen::VectorXd angles = m.angleChange(faces);
  const std::vector<io::VertexMap> distortionMaps = {
      {"area ratio", "", unfolding::vertexMeans(m.reference, m.moved, movedRatio, 1)},
      {"angle change", "degrees", unfolding::vertexMeans(m.reference, faces, angles, 0)},
      {"edge strain", "", unfolding::vertexStrains(m.reference, after.positions, faces)}};
  io::writeGiftiShape(context.output("distortion.shape.gii"), distortionMaps, structure);

  const io::LabelMap label = regionLabel(u);
  io::writeGiftiLabel(context.output("region.label.gii"), label, structure);

  std::vector<io::VertexMap> allVertexMaps = visibilityMaps;
  allVertexMaps.insert(allVertexMaps.end(), distortionMaps.begin(), distortionMaps.end());
  allVertexMaps.push_back({"region", "", label.keys.cast<double>()});
  Eigen::VectorXd faceSeenBefore = m.seenBefore.face;
  if (after.faceCount() != u.before.faceCount()) {  // the region alone
    faceSeenBefore.resize(after.faceCount());
    for (std::size_t n = 0; n < faces.size(); ++n) {
      faceSeenBefore[faces[n]] = m.seenBefore.face[u.chosen.faces[n]];
    }
  }
  io::writeVtp(context.output("unfolded.vtp"), after, allVertexMaps,
               {{"area ratio", "", m.areaRatio},
                {"angle change", "degrees", m.angleChange},
                {"seen before", "", faceSeenBefore},
                {"seen after", "", m.seenAfter.face}});
  writeTextFile(context.output("evolution.tsv"), unfolding::evolutionTable(u.result.history));
  unfolding::writeCheckpoint(context.output(kStateFile), u.result.checkpoint);
}

/// @param before  pairs that cross at the start, among the faces that are written
void writeFrames(Context& context, const Unfolded& u, const Measures& m,
                 const std::vector<geometry::FacePair>& before) {
  if (u.result.frames.empty()) return;
  std::vector<bool> moved(static_cast<std::size_t>(u.result.mesh.faceCount()), false);
  for (const std::int32_t f : m.moved) moved[f] = true;
  std::size_t most = 0;
  std::vector<double> visibilities;
  for (std::size_t n = 0; n < u.result.frames.size(); ++n) {
    const TriangleMesh frame{unfolding::roundedToSingle(u.result.frames[n].positions),
                             u.result.mesh.faces};
    most = std::max(most, unfolding::crossingsAfterMotion(frame, moved, before).size());
    visibilities.push_back(u.result.frames[n].visibility);
    char name[64];
    std::snprintf(name, sizeof name, "frames/frame-%04zu.surf.gii", n);
    io::writeGiftiSurface(context.output(name), frame, u.metadata);
  }
  context.result("frame_visibilities", visibilities);
  context.result("self_intersections_frames_max", most);
}

void reportRegion(Context& context, const Unfolded& u, const Measures& m) {
  const TriangleMesh& after = u.result.mesh;
  const unfolding::Region& region = u.result.region;
  const auto& faces = region.faces;
  const auto visibilityOf = [&](const TriangleMesh& mesh) {
    return visibility::AverageVisibility(mesh.faces, faces, u.view).value(mesh.positions);
  };
  std::vector<double> eyes;
  for (const Point& eye : u.view.points) eyes.insert(eyes.end(), eye.begin(), eye.end());
  context.result("viewpoint", eyes);
  context.result("viewpoint_weights", u.view.weights);
  context.result("region_faces", faces.size());
  context.result("region_vertices", region.vertices.size());
  context.result("region_pieces", region.pieces);
  context.result("region_holes", region.holes);
  context.result("region_area",
                 geometry::totalArea(geometry::extractFaces(m.reference, faces).mesh));
  context.result("visibility_initial", visibilityOf(m.reference));
  context.result("visibility_final", visibilityOf(after));
  context.result("flux_variance_initial", visibility::fluxVariance(m.reference, faces, u.view));
  context.result("flux_variance_final", visibility::fluxVariance(after, faces, u.view));
  context.result("seen_initial", m.seenBefore.of(u.before, u.chosen.faces));
  context.result("seen_final", m.seenAfter.of(after, faces));
  context.result("real_visibility_initial", m.seenBefore.realOf(u.before, u.chosen.faces));
  context.result("real_visibility_final", m.seenAfter.realOf(after, faces));
  context.result("backfacing_initial", unfolding::backfacingShare(m.reference, faces, u.view));
  context.result("backfacing_final", unfolding::backfacingShare(after, faces, u.view));
  context.result("area_error_mean", m.distortion.areaErrorMean);
  context.result("area_error_max", m.distortion.areaErrorMax);
  context.result("angle_error_mean_deg", m.distortion.angleErrorMeanRad * 180 / kPi);
  context.result("edge_strain_mean", m.distortion.edgeStrainMean);
  context.result("edge_strain_p95", m.distortion.edgeStrainP95);
  context.result("geodesic_error_mean", m.distortion.geodesicErrorMean);
}

/// The faces that moved outside the region.
void reportCollar(Context& context, const Unfolded& u, const Measures& m) {
  const auto& collar = u.result.collar;
  context.result("collar_faces", collar.size());
  if (collar.empty()) return;
  const Eigen::VectorXd stretch = m.areaRatio(collar);
  context.result("collar_stretch_mean", stretch.mean());
  context.result("collar_stretch_max", stretch.maxCoeff());
}

void reportRun(Context& context, const Unfolded& u) {
  const auto& last = u.result.history.back();
  unfolding::PhaseSeconds phases;
  for (const unfolding::IterationRecord& row : u.result.history) phases += row.phases;
  context.result("iterations", last.iteration);
  context.result("iteration_written", u.result.iteration);
  context.result("seconds_visibility", phases.visibility);
  context.result("seconds_repulsion", phases.repulsion);
  context.result("seconds_collision", phases.collision);
  context.result("seconds_solve", phases.solve);
  context.result("seconds_per_iteration", last.iteration > 0 ? last.seconds / last.iteration : 0);
}

/// What the surroundings had to give for the region to be seen.
void checkCollar(Context& context, Unfolded& u, const Measures& m) {
  const auto& collar = u.result.collar;
  if (collar.empty()) return;
  const Eigen::VectorXd stretch = m.areaRatio(collar);
  const double mean = stretch.mean(), most = stretch.maxCoeff();
  if (most <= unfolding::kCollarMost) return;
  const auto beyond = (stretch.array() > unfolding::kCollarMost).count();
  const bool elastic = u.surround == unfolding::Surround::Elastic;
  char text[240];
  std::snprintf(
      text, sizeof text,
      "%lld of %zu faces around the region are stretched to more than %g times their area, "
      "one to %.1f times; %.2f times in the mean%s",
      static_cast<long long>(beyond), collar.size(), unfolding::kCollarMost, most, mean,
      elastic ? "" : ": with --surround elastic more of them follow, and stretch less");
  context.warn(text);
  if (!elastic || mean <= unfolding::kCollarMean) return;
  if (u.result.flag == unfolding::Flag::None) u.result.flag = unfolding::Flag::Stretched;
  if (reachedGoal(u.result.termination)) u.result.termination = Termination::Stalled;
}

/// A region that looks at the viewpoint but lies under something else is not unfolded either.
void checkSeen(Context& context, Unfolded& u, const Measures& m, double goal) {
  const double seen = m.seenAfter.of(u.result.mesh, u.result.region.faces);
  const Termination end = u.result.termination;
  const bool atRest = end == Termination::Converged || end == Termination::Finished;
  char text[160];
  if (end == Termination::Converged && seen < unfolding::kGoalSeen) {
    u.result.termination = Termination::Finished;
    std::snprintf(text, sizeof text,
                  "%.4f of the region's area can be seen in what is written; the goal is %g", seen,
                  unfolding::kGoalSeen);
    context.warn(text);
  }
  if (!(atRest || end == Termination::Stalled) || seen >= goal - unfolding::kHeldBelow) return;
  if (u.result.flag == unfolding::Flag::None) u.result.flag = unfolding::Flag::Held;
  u.result.termination = Termination::Stalled;
  std::snprintf(text, sizeof text,
                "the region is held: only %.3f of its area can be seen from the viewpoint", seen);
  context.warn(text);
}

/// What the file holds against what the method promises.
void checkWritten(Context& context, Unfolded& u, const unfolding::CrossingAccount& crossings) {
  context.result("self_intersections_final", crossings.after.size());
  context.result("self_intersections_new", crossings.added);
  context.result("crossings_with_rest", crossings.withRest);
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
  writeFrames(context, u, m, whole ? u.crossings : std::vector<geometry::FacePair>{});
  context.result("surround", std::string(nameOf(u.surround)));
  reportRegion(context, u, m);
  reportCollar(context, u, m);
  reportRun(context, u);
  checkSeen(context, u, m, u.goal);
  checkCollar(context, u, m);
  checkWritten(context, u, crossings);
  context.result("flag", std::string(nameOf(u.result.flag)));
  context.result("stop_reason", std::string(nameOf(u.result.termination)));
  return u.result.termination;
}

}  // namespace explica::app
