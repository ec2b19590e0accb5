// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/Summary.h"

namespace explica::planar {
namespace {

void describeView(Results& t, const std::vector<double>& viewpoints,
                  const std::vector<double>& weights) {
  t.list("viewpoint", "Viewpoint", "mm", "Coordinates of each.", viewpoints);
  t.list("viewpoint_weights", "Weights of the viewpoints", "", "", weights);
}

}  // namespace

void describe(Results& t, const PolygonSummary& s) {
  t.count("region_edges", "Edges of the region", "", s.regionEdges).inHead();
  t.number("length_initial", "Length of the region at the start", "", "In the units of the file.",
           s.length);
  t.number("area", "Area of the polygon", "", "", s.area);
  t.count("self_intersections_initial", "Self-intersections at the start", "Pairs of edges.",
          s.crossings);
}

void describe(Results& t, const PolygonUnfoldSummary& s) {
  describeView(t, s.viewpoints, s.weights);
  t.number("length_final", "Length of the region", "", "In the units of the file.", s.end.length)
      .after("length_initial")
      .inHead();
  t.share("length_error_max", "Largest length error", "Of an edge of the region.",
          s.keepsLength ? s.end.lengthError : kNaN)
      .atMost(1e-3, Judgement::Look, "lengths are constraints")
      .inHead();
  t.change("visibility", "Average visibility", "",
           "Mean cosine between the normals of the region's edges and the viewpoint.",
           {s.start.visibility, s.end.visibility})
      .atLeast(s.target, Judgement::Look, "the visibility asked for")
      .inHead();
  t.change("flux_variance", "Variance of the flux", "", "Of the cosines over the region.",
           {s.start.variance, s.end.variance});
  t.change("seen", "Seen from the viewpoint", "share",
           "Share of the region's length that nothing hides.",
           {s.before.fraction, s.after.fraction})
      .inHead();
  t.change("real_visibility", "Visibility of what is seen", "", "Seen share times cosine.",
           {s.before.realVisibility, s.after.realVisibility});
  t.count("self_intersections_final", "Self-intersections", "Pairs of edges, exact.", s.crossings)
      .exactly(0, Judgement::Look, "a polygon does not cross itself");
  t.count("first_crossing", "Iteration of the first crossing", "-1: never.", s.firstCrossing);
  t.count("vertices_merged", "Vertices merged", "Of edges that shrank away.", s.verticesMerged);
  t.count("iterations", "Iterations", "", s.end.iteration).inHead();
  t.number("seconds", "Time of the unfolding", "s", "", s.seconds);
  t.number("seconds_topology", "Time for knot energy, barrier and collision detection", "s", "",
           s.secondsTopology);
  t.text("stop_reason", "Stop reason", "", s.stopReason);
}

}  // namespace explica::planar
