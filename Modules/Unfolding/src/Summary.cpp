// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Summary.h"

#include <algorithm>

namespace explica::unfolding {

void describe(Results& t, const StartSummary& s) {
  t.count("self_intersections_initial", "Intersecting pairs of faces at the start",
          "Found by an exact test; intersections.tsv lists them.", s.crossings);
  t.count("self_intersections_initial_region", "Of them with a face in the region", "", s.inRegion);
  t.count("self_intersections_repaired", "Of them repaired", "By small moves of vertices.",
          s.parted);
  t.count("repair_vertices_moved", "Vertices moved by the repair", "", s.moved);
  t.number("repair_move_max", "Largest displacement by the repair", "mm", "", s.moveMax);
  t.number("repair_move_mean", "Mean displacement by the repair", "mm", "Of the moved vertices.",
           s.moveMean);
}

void describe(Results& t, const FrameSummary& s) {
  t.list("frame_visibilities", "Visibility of each frame", "share", "", s.visibilities);
  t.count("self_intersections_frames_max", "Intersecting pairs of faces in a frame", "At most.",
          s.mostCrossings);
}

void describe(Results& t, const EndSummary& s) {
  t.count("iterations", "Iterations", "", s.iterations);
  t.text("flag", "Not as asked for",
         "held: a goal is missed (visibility, seen, strain); worse: no state was better than the "
         "start; crossing: new self-intersections; stretched: the collar gave way.",
         s.flag)
      .exactly(0, Judgement::Doubt, "the warnings say why");
  t.text("stop_reason", "Stop reason", "", s.stopReason);
}

namespace {

std::vector<double> coordinatesOf(const visibility::Viewpoints& view) {
  std::vector<double> all;
  for (const Point& eye : view.points) all.insert(all.end(), eye.begin(), eye.end());
  return all;
}

void describeRegion(Results& t, const UnfoldSummary& s) {
  t.text("reference", "Surface that the result is compared with",
         "SURFACE as it was read, or reference.surf.gii where faces that crossed were parted.",
         s.reference);
  t.text("surround", "Surroundings", "What happens to the faces around the region.", s.surround);
  t.list("viewpoint", "Viewpoint", "mm", "Coordinates of each, RAS.", coordinatesOf(s.view));
  t.list("viewpoint_weights", "Weights of the viewpoints", "", "", s.view.weights);
  t.count("region_faces", "Faces of the region", "", s.regionFaces);
  t.count("region_vertices", "Vertices of the region", "", s.regionVertices);
  t.count("region_pieces", "Pieces of the region", "Each unfolds on its own.", s.regionPieces);
  t.count("region_holes", "Holes in the region", "They stay open.", s.regionHoles);
  t.number("region_area", "Area of the region", "mm^2", "", s.regionArea).inHead();
}

void describeView(Results& t, const UnfoldSummary& s) {
  const double goal = std::min(s.target, kGoalVisibility), toSee = std::min(goal, kGoalSeen);
  t.change("visibility", "Average visibility", "",
           "Mean cosine between the normals of the region's faces and the viewpoint.", s.visibility)
      .atLeast(goal, Judgement::Doubt, "the goal of an unfolding")
      .inHead()
      .compared();
  t.change("flux_variance", "Variance of the flux", "",
           "Of the cosines over the region's faces: 0 if all look at the viewpoint alike.",
           s.fluxVariance);
  t.change("seen", "Seen from the viewpoint", "share",
           "Share of the region's area that nothing hides.", s.seen)
      .atLeast(toSee, Judgement::Doubt, "the goal of an unfolding")
      .inHead()
      .compared();
  t.change("real_visibility", "Visibility of what is seen", "", "Seen share times cosine.",
           s.realVisibility);
  t.change("backfacing", "Looking away", "share",
           "Share of the region's area whose normals look away.", s.backfacing);
}

void describeCollar(Results& t, const UnfoldSummary& s) {
  t.count("collar_faces", "Faces of the collar", "Outside the region, with a vertex that moves.",
          s.collarFaces);
  t.number("collar_stretch_mean", "Mean area ratio of the collar", "", "After over before.",
           s.collarStretchMean)
      .atMost(kCollarMean, Judgement::Look, "a collar that follows");
  t.number("collar_stretch_max", "Largest area ratio in the collar", "", "", s.collarStretchMax)
      .atMost(kCollarMost, Judgement::Look, "a collar that follows");
}

void describeCrossings(Results& t, const UnfoldSummary& s) {
  t.count("self_intersections_final", "Self-intersections",
          "Pairs of faces of the whole surface, by an exact test.", s.crossings)
      .exactly(0, Judgement::Look, "a surface does not cross itself");
  t.count("self_intersections_new", "New self-intersections", "Not there at the start.",
          s.crossingsNew)
      .exactly(0, Judgement::Doubt, "no step intersects");
  Result& rest =
      t.count("crossings_with_rest", "Intersections with the surface it came from",
              "Pairs of a face that moved and a face of that surface.", s.crossingsWithRest);
  if (s.surround != Surround::None) {
    rest.exactly(0, Judgement::Look, "the patch opens in its place");
  }
}

}  // namespace

void describe(Results& t, const UnfoldSummary& s) {
  describe(t, s.frames);
  describeRegion(t, s);
  describeView(t, s);
  describe(t, s.distortion);
  expectAreasKept(t);
  t["edge_strain_mean"].atMost(kGoalStrain, Judgement::Doubt, "the goal of an unfolding");
  describeCollar(t, s);
  t.count("iteration_written", "Iteration that is written",
          "The last, or the best if that was better.", s.iterationWritten);
  t.number("seconds_visibility", "Time for the terms of the region", "s", "", s.phases.visibility);
  t.number("seconds_repulsion", "Time for the knot energy", "s", "", s.phases.repulsion);
  t.number("seconds_collision", "Time for collision detection", "s", "", s.phases.collision);
  t.number("seconds_solve", "Time for linear systems", "s", "", s.phases.solve);
  t.number("seconds_per_iteration", "Time of an iteration", "s", "", s.secondsPerIteration);
  describeCrossings(t, s);
  describe(t, s.end);
}

}  // namespace explica::unfolding
