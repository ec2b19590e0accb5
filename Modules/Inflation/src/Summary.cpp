// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Inflation/Summary.h"

namespace explica::inflation {

void describe(Results& t, const InflateSummary& s) {
  t.count("faces", "Faces", "", s.faces);
  t.count("vertices", "Vertices", "", s.vertices);
  t.number("area", "Area at the start", "mm^2", "", s.area);
  t.change("volume", "Enclosed volume", "mm^3", "", s.volume);
  t.count("viewpoints", "Points of the enclosing sphere", "From which visibility is judged.",
          s.viewpoints);
  t.change("visibility", "Global visibility", "",
           "Visibility from all directions; 1 for convex surfaces only.", s.visibility)
      .atLeast(s.target, Judgement::Look, "the visibility asked for")
      .inHead();
  t.change("seen", "Seen from somewhere", "share",
           "Share of the area that any point of the enclosing sphere sees.", s.seen)
      .inHead();
  describe(t, s.distortion);
  unfolding::expectAreasKept(t);
  describe(t, s.distances);
  t.count("turned_over", "Faces turned over", "Against the mean normal at their corners.",
          s.turnedOver);
  describe(t, s.frames);
  t.number("drive", "Drive", "", "How much harder than at first the surface was driven.", s.drive);
  t.number("seconds_collision", "Time for collision detection", "s", "", s.phases.collision);
  t.number("seconds_solve", "Time for linear systems", "s", "", s.phases.solve);
  t.count("self_intersections_final", "Self-intersections", "Pairs of faces, by an exact test.",
          s.crossings)
      .exactly(0, Judgement::Look, "a surface does not cross itself");
  t.count("self_intersections_new", "New self-intersections", "Not there at the start.",
          s.crossingsNew)
      .exactly(0, Judgement::Doubt, "no step intersects");
  describe(t, s.end);
}

}  // namespace explica::inflation
