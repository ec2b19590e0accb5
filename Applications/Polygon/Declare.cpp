// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Settings.h"

#include "Explica/Planar/Summary.h"

namespace explica::app {

void declarePolygon(Declaration& d, PolygonSettings& s) {
  d.synopsis("a region of a polygon opened towards a viewpoint, lengths kept")
      .description(
          R"(Moves the region's vertices until every edge faces the viewpoint. Edges of the region keep their lengths and never cross. The polygon comes from a file, or is the sub-pixel contour of a label in a slice of an image; without a viewpoint it is only measured and written. A run can be stopped at any time and continued with --resume into the same --out.)")
      .reference("Rocha, Yezzi, Tannenbaum 2007, IEEE Int. Conf. Image Processing")
      .example("explica polygon --phantom polygon34 --out flat",
               "Unfold a polygon of 34 edges from its viewpoint; evolution.svg shows the stages")
      .example("explica polygon contour.csv --region 10:60 --direction 0,1 --resume --out open",
               "Go on with a run on edges 10 to 60 that was stopped")
      .example("explica polygon ED_label.nii.gz --label-key 2 --slice 4 --out contour",
               "Outer contour of a label, RAS mm")
      .input("FILE", FileKind::Any, "polygon (CSV, VTK polydata), or label image", s.file)
      .category("Contour")
      .option("phantom", "instead of FILE: a phantom with its region and viewpoint", s.phantom);
  declarePolygonReading(d, s.reading);
  d.category("Region")
      .option("region",
              "first and last vertex, I:J, or seen: between the extremities of the view; "
              "default: the whole polygon",
              s.region)
      .category("Viewpoint")
      .option({"viewpoint", "mm", "point to look from; of several the weighted mean counts"},
              s.viewpoint)
      .option("direction", "look from the region's centroid plus --distance along this",
              s.direction)
      .option({"distance", "mm", "how far off a viewpoint given by --direction is"}, s.distance)
      .option({"view-weights", "",
               "weights of several viewpoints or directions, one each, in their order "
               "(default: equal)",
               kAboveZero},
              s.weights)
      .option({"view-line", "mm", "look from all points of the line X,Y,X,Y between two"}, s.line)
      .options("Unfolding", s.unfolding)
      .category("Unfolding")
      .option("resume", "continue the run whose outputs are in --out", s.resume)
      .reuseOutputIf(s.resume)
      .category("Output")
      .option({"frames", "", "write this many states on the way", 0, 100000}, s.frames)
      .option({"stages", "", "panels of evolution.svg", 1, 1000}, s.stages)
      .needs({"distance"}, {"direction"})
      .output("polygon.csv", FileKind::Polygon, "the polygon as it was understood")
      .output("unfolded.csv", FileKind::Polygon, "the unfolded polygon")
      .output("unfolded.vtp", FileKind::Polygon, "the same with flux and seen share of each edge")
      .varyingOutput("evolution.tsv", FileKind::Table, "one row an iteration")
      .output("evolution.svg", FileKind::Picture,
              "start, stages and end, with the direction of view")
      .output("frames/frame-*.csv", FileKind::Polygon, "states on the way")
      .varyingOutput(kPolygonState, FileKind::Any, "what --resume needs")
      .results<planar::PolygonSummary>()
      .results<planar::PolygonUnfoldSummary>();
}

}  // namespace explica::app
