// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Settings.h"

#include "Explica/Unfolding/Summary.h"
#include "Outputs.h"

namespace explica::app {

void declareUnfold(Declaration& d, UnfoldSettings& s) {
  d.synopsis("a region of a folded surface opened towards a viewpoint, areas kept")
      .description(
          R"(Maximises the average visibility of the region: the mean cosine under which its faces look at the viewpoint. Face areas are kept, edges keep their lengths as well as they can, and a band of the surface around the region, the collar, stretches with it. With the implicit method no step lets the surface pass through itself, and faces that intersect at the start are parted first where the region or its collar is concerned; the thesis's method promises nothing of the kind. What is written is tested once more: faces that cross in it and did not at the start, a goal that is missed (visibility 0.98 or --target-visibility, as much seen, mean edge strain 9 %), a collar that gives way (twice its area in the mean, a face at more than eight times), and a run that never got better than its start end with a warning that says which, a 'flag' in the summary and exit code 3. A run can be stopped at any time; after its first iteration it writes what is reached, and --resume into the same --out goes on.)")
      .reference(
          "Lopez Perez 2010, Two- and three-dimensional annular tissues and unfolding, thesis")
      .example(
          R"(explica unfold pial.surf.gii --center -60,10,20 --radius 25 --direction -1,0.2,0.2 --out unfolded)",
          "A patch of 25 mm about a point, seen from its side")
      .input("SURFACE", FileKind::Surface, "triangulated surface", s.surface)
      .options("Reading", s.reading)
      .options("View", s.view)
      .inputOption("view-surface", FileKind::Surface, "look from all points of this surface",
                   s.viewSurface, "View")
      .options("Region", s.region)
      .inputOption("label", FileKind::VertexLabel,
                   "the region is where this label, or one of several, is not 0; with --above, "
                   "where this map is above that",
                   s.labels, "Region")
      .category("Region")
      .option("label-key",
              "the region is where --label has one of these keys or, of an annotation, "
              "names (K,K,... or repeated)",
              s.labelKeys)
      .option("above", "value beyond which the map --label is in the region", s.above)
      .excludes("label", {"center", "vertex", "radius", "metric", "cone"})
      .excludes("label-key", {"above"})
      .excludes("center", {"vertex"})
      .excludes("cone", {"metric"})
      .needs({"label-key"}, {"label"})
      .needs({"above"}, {"label"})
      .needs({"distance"}, {"direction"})
      .category("Unfolding")
      .option("repair",
              "remove self-intersections of region and collar first (of all the surface, if "
              "given explicitly); distortion is measured against the repaired surface",
              s.repair)
      .options("Unfolding", s.unfold)
      .needs({"knot-weight"}, {"knot"})
      .option("resume", "continue the run whose outputs are in --out", s.resume)
      .reuseOutputIf(s.resume)
      .output("unfolded.surf.gii", FileKind::Surface, "the surface with its region unfolded")
      .output(kReferenceFile, FileKind::Surface,
              "the surface that the result is compared with, where faces that crossed were parted")
      .output("unfolded.vtp", FileKind::Surface, "the same with all values of vertices and faces")
      .output("region.label.gii", FileKind::VertexLabel, "1 in the region")
      .output("visibility.shape.gii", FileKind::VertexData,
              "flux before, flux after, seen before, seen after")
      .output("distortion.shape.gii", FileKind::VertexData,
              "area ratio (of all faces that move), angle change in degrees, edge strain")
      .varyingOutput("evolution.tsv", FileKind::Table, "one row per iteration")
      .output("intersections.tsv", FileKind::Table,
              "pairs of faces that intersect at the start, where, and whether --repair parted them")
      .output("frames/frame-*.surf.gii", FileKind::Surface, "--frames states on the way")
      .varyingOutput(kUnfoldingState, FileKind::Any, "what --resume needs")
      .results<unfolding::StartSummary>()
      .results<unfolding::UnfoldSummary>();
}

}  // namespace explica::app
