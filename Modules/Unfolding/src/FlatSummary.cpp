// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/FlatSummary.h"

namespace explica::unfolding {

void describe(Results& t, const FlatSummary& s) {
  static const flattening::Disc noDisc;
  static const flattening::FlatMap noMap;
  const flattening::Disc& disc = s.disc ? *s.disc : noDisc;
  const flattening::FlatMap& map = s.map ? *s.map : noMap;
  std::optional<std::int64_t> frames;
  if (s.turnedOverInFrames) frames = map.frames.size();
  t.number("area", "Area of the patch", "mm^2", "On the surface where areas and lengths count.",
           s.area)
      .inHead();
  t.share("area_tolerance", "Area error asked for", "", s.areaTolerance);
  describe(t, s.distortion);
  constexpr double kRounding = 1.02;  // the map ends where the energy's areas reach the goal
  t["area_error_mean"].atMost(kRounding * s.areaTolerance, Judgement::Look, "as asked for");
  describe(t, s.distances);
  t.count("frames", "Frames", "States on the way.", frames);
  t.count("turned_over_frames_max", "Faces turned over in a frame", "At most.",
          s.turnedOverInFrames);
  t.count("faces", "Faces", "", disc.mesh.faceCount());
  t.count("vertices", "Vertices", "", disc.vertexOrigin.size());
  t.count("faces_trimmed", "Faces left out", "Joined to the rest by a single vertex.",
          disc.trimmedFaces);
  t.count("pieces_left_out", "Pieces left out", "All but the largest.", disc.otherPieces);
  t.share("area_left_out", "Area of these", "Of all that was to be laid flat.", disc.areaOfOthers);
  t.count("faces_raised", "Needles raised", "Faces of the reference whose height was raised.",
          map.raisedFaces);
  t.count("holes", "Holes", "They stay open.", disc.holes.size());
  t.count("turned_over", "Faces turned over", "By an exact test.", map.turnedOver)
      .exactly(0, Judgement::Doubt, "one-to-one");
  t.count("rim_crossings", "Crossings of the rim", "Pairs of rim edges, by an exact test.",
          map.rimCrossings)
      .exactly(0, Judgement::Doubt, "one-to-one");
  t.count("iterations", "Iterations", "At full resolution.", map.iterations);
  t.text("stop_reason", "Stop reason", "", map.termination);
}

}  // namespace explica::unfolding
