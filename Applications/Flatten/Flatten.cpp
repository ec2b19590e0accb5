// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Flatten.h"

#include "AutomaticCuts.h"
#include "Explica/Application/Command.h"
#include "Explica/Application/Describing.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Application/TimeKept.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Core/Text.h"
#include "Explica/Flattening/State.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "PatchOutputs.h"
#include "Stack.h"

#include <algorithm>

namespace explica::app {
namespace {

constexpr double kPatchTolerance = 0.01;  // mean area error of a patch ...
constexpr double kCutTolerance = 0.05;    // ... and of a hemisphere with cuts: less costs lengths
constexpr const char* kFlatteningState = "flattening.state";

void declareFlatOutputs(Declaration& d) {
  d.output("flat.surf.gii", FileKind::Surface,
           "the flat map, z = 0: all vertices in their order, the patch's faces (one bank of cuts)")
      .output("patch.surf.gii", FileKind::Surface,
              "the reference, the patch's vertices only, in the order of vertex_of.shape.gii")
      .output("patch_flat.surf.gii", FileKind::Surface, "the flat map of patch.surf.gii")
      .output("vertex_of.shape.gii", FileKind::VertexData,
              "for each vertex of patch.surf.gii its number in the whole surface")
      .output("*.patch.flat", FileKind::Any, "the flat map as FreeSurfer writes it")
      .output("*.patch.3d", FileKind::Any, "the patch on the reference, as FreeSurfer writes it")
      .output("cuts.tsv", FileKind::Table,
              "of --cuts auto and template: name, ends (vertices), length (mm), mean depth "
              "(standard deviations)")
      .output("cuts.label.gii", FileKind::VertexLabel,
              "of --cuts auto and template: the wall and each cut")
      .output("distortion.shape.gii", FileKind::VertexData,
              "area ratio, angle change in degrees, edge strain")
      .output("patch_*.label.gii", FileKind::VertexLabel,
              "each file of --regions on the vertices of patch.surf.gii, names and colours kept")
      .output("patch.tsv", FileKind::Table, "area and means of maps, per region and in all")
      .output("grid.nii.gz", FileKind::PointVolume, "place (RAS mm) of each cell (u, v, depth)")
      .output("to_flat.nii.gz", FileKind::PointVolume,
              "u, v (mm) and depth (0 to 1) of each voxel of the first volume")
      .output("flat_*.nii.gz", FileKind::Volume, "each volume on the grid")
      .output("flat.png", FileKind::Picture, "the map with outlines, scale bar and colour bar")
      .output("frames/frame-*.surf.gii", FileKind::Surface,
              "--frames states on the way, vertices and faces as in flat.surf.gii")
      .varyingOutput(kFlatteningState, FileKind::Any, "what --resume needs")
      .results<flattening::CutPlan>()
      .results<unfolding::FlatSummary>();
}

void declare(Declaration& d, FlattenSettings& s) {
  d.synopsis("a patch, or a hemisphere with cuts, as a flat map without folds")
      .description(
          R"(Flattens a surface with a rim: exactly planar, without folds or overlaps; face areas are kept closely, lengths as well as possible. Areas and lengths are those of --reference (same vertices); for an 'unfolded.surf.gii' of 'explica unfold' they are those of the surface that its record names, and the region is its own. Holes stay open; a part joined to the rest by a single vertex is left out, and so are, said with their area, all pieces but the one with more than half of the area.

A closed surface needs --center or --vertex with --radius, or --label (a patch), or --cuts (a hemisphere): a FreeSurfer patch or a label of the vertices that stay, or a flat map whose faces stay.

--cuts auto takes the medial wall out (--cortex; or lh.cortex.label or valid.shape.gii beside the surface; or the flattest fortieth of it) and finds relief cuts: each ends where a conformal map would change lengths most and comes along the sulci, where a way costs half as much for each standard deviation of depth; of five such cuts the one is taken that lowers the strain most for its length, until --cut.strain is reached. No face is lost: vertices along a cut become two, the second copies last in patch.surf.gii. Where a vertex has one place only, what touches a second copy is left out: of flat.surf.gii faces, of FreeSurfer's patches the vertices on cuts.

--cuts template lays the medial wall and the cuts of --template on the surface through its sphere in register (explica register), so that the maps of all people show the same cuts. They are those of lh.cuts.label.gii in the template's folder, a label file of its vertices (1 the wall, 2 and on the cuts, each from the wall or an earlier cut inwards) such as --cuts auto writes; else they are found on its white surface, and named by the region in which they end.

The map grows from a circle of few vertices to all of them, and is one-to-one from the start. A run that is stopped, by a signal or by --max-time, writes the cuts found until then or the map as far as it came, whole and one-to-one as ever, and ends with exit code 3; --resume into the same --out goes on to the very map of a run that never stopped. --frames shows the way.

With --surfaces, or --white and --pial, the map becomes a stack of depths: grid.nii.gz gives each cell its place in the tissue (RAS mm), --volumes are resampled into it (--to-volume where they were measured elsewhere), and to_flat.nii.gz gives each voxel of the first volume its u and v (mm in the map) and depth (0 at the white surface, 1 at the pial).)")
      .reference("Tutte 1963, Proceedings of the London Mathematical Society 13:743-767")
      .reference("Shen, Jiang, Zorin, Panozzo 2019, ACM Transactions on Graphics 38(4):32")
      .example(
          R"(explica flatten unfolded/unfolded.surf.gii --surfaces surfaces --volumes T1.nii.gz --out flat)",
          "The flat map of an unfolded patch, and a volume as a stack of depths")
      .example("explica flatten lh.pial --cuts lh.cortex.patch.3d --out flat",
               "A hemisphere with given cuts")
      .example("explica flatten lh.pial --cuts auto --out flat", "A hemisphere, cut by the program")
      .example("explica flatten sub-01/surface-L/mid.surf.gii --cuts template --out flat",
               "The same cuts on everybody")
      .reference("Ben-Chen, Gotsman, Bunin 2008, Computer Graphics Forum 27(2):449-458")
      .input("SURFACE", FileKind::Surface, "triangulated surface with a rim, or to be cut",
             s.surface)
      .options("Reading", s.reading)
      .inputOption("reference", FileKind::Surface,
                   "surface with the same vertices whose areas and lengths count", s.reference)
      .category("Region")
      .option("cuts",
              "what stays of a hemisphere: FreeSurfer patch, label (not 0) or flat map; "
              "auto: cuts are found; template: those of --template",
              s.cuts)
      .option("template", "whose cuts they are, as of register", s.templateName)
      .option("cut-name", "only those of the template's cuts; all by default", s.cutNames)
      .inputOption("sphere", FileKind::Surface,
                   "the surface's sphere in register with the template (default: ?h.sphere.reg "
                   "beside it, or of explica run)",
                   s.sphere, "Region")
      .inputOption("cortex", FileKind::VertexData,
                   "for --cuts auto, where there is cortex: label, annot, or map (not 0)", s.cortex,
                   "Region")
      .options("Region", s.cut, "cut.")
      .options("Region", s.region)
      .without("cone")
      .inputOption("label", FileKind::VertexLabel,
                   "lay flat only where this label, or one of several, is not 0", s.labels,
                   "Region")
      .option("label-key", "lay flat only where --label has one of these keys", s.labelKeys)
      .category("Flattening")
      .option({"area-tolerance", "",
               "mean relative area error to reach (default: 0.01; with --cuts 0.05)", 1e-6, 1},
              s.areaTolerance)
      .options("Flattening", s.flatten, "solver.")
      .without("solver.area-tolerance")
      .without("solver.frames")
      .option(
          {"frames", "", "states to write on the way, evenly spaced along the way that vertices go",
           0, kMostFrames},
          s.flatten.frames)
      .option("resume", "continue the run whose outputs are in --out", s.resume)
      .reuseOutputIf(s.resume)
      .category("Grid")
      .option({"grid", "mm", "size of the grid's cells along u and v", 1e-3, 1e3}, s.grid)
      .option(
          {"depths", "",
           "layers from white to pial (default: 5 with white and pial surface, else 1)", 1, 1000},
          s.depths);
  declareCortex(d, s.sheet, "Grid");
  declarePlace(d, s.place, "Grid");
  d.inputOption("volumes", FileKind::Volume, "volumes to resample into the grid, 3-D or 4-D",
                s.volumes, "Grid")
      .severalWords("volumes")
      .option("nearest", "the nearest voxel's value, for label volumes", s.nearest)
      .inputOption("map", FileKind::VertexData,
                   "values on the vertices, for patch.tsv; the first colours flat.png", s.maps,
                   "Patch")
      .inputOption("regions", FileKind::VertexLabel,
                   "regions for patch.tsv, their outlines in their own colours for flat.png",
                   s.regions, "Patch")
      .excludes("center", {"vertex"})
      .excludes("label", {"center", "vertex"})
      .excludes("cuts", {"center", "vertex"})
      .needs({"radius", "metric"}, {"center", "vertex"})
      .needs({"label-key"}, {"label"})
      .needs({"cortex", "cut.strain", "cut.most"}, {"cuts=auto"})
      .needs({"template", "cut-name", "sphere"}, {"cuts=template"})
      .needs({"depths"}, {"surfaces", "white"})
      .needs({"nearest"}, {"volumes"});
  declareFlatOutputs(d);
}

void warnOf(Context& context, const flattening::Disc& disc, const flattening::FlatMap& map) {
  if (disc.trimmedFaces > 0) {
    context.warn(std::to_string(disc.trimmedFaces) +
                 " faces are joined to the rest by a single vertex only and were left out");
  }
  if (disc.otherPieces > 0) {
    context.warn(
        printed("the region has %zu pieces; the largest is laid flat, the others (%.1f %% of the "
                "area) are left out",
                disc.otherPieces + 1, 100 * disc.areaOfOthers));
  }
  if (!disc.holes.empty()) {
    context.warn("the surface has " + std::to_string(disc.holes.size()) +
                 (disc.holes.size() == 1 ? " hole; it stays open" : " holes; they stay open"));
  }
  if (map.turnedOver > 0 || map.rimCrossings > 0) {
    context.warn(std::to_string(map.turnedOver) + " faces are turned over and " +
                 std::to_string(map.rimCrossings) +
                 " pairs of rim edges meet in single precision: the map is not one-to-one there");
  }
}

void sayWhetherUsable(Context& context, const flattening::FlatMap& map) {
  const bool folded = map.turnedOver > 0 || map.rimCrossings > 0;
  context.info(printed("flat map: %s%s",
                       folded ? "not usable, it folds or overlaps" : "usable, one-to-one",
                       map.termination == Termination::MaxIterations
                           ? "; ended at its limit of iterations (--solver.max-iterations)"
                           : ""));
}

/// The run from the opened surface on: its disc, its map, and what going on needs.
struct Made {
  flattening::Disc disc;
  flattening::FlatMap map;
  flattening::Checkpoint state;
  double secondsCut = 0;

  /// Whether it was not stopped before there was a map.
  [[nodiscard]] bool hasMap() const { return disc.mesh.faceCount() > 0; }
};

Made make(Context& context, const FlattenSettings& s, const Subject& subject, flattening::Disc disc,
          const flattening::FlattenOptions& options) {
  const Stopwatch seconds;
  std::optional<flattening::Checkpoint> from;
  if (s.resume) from = flattening::readCheckpoint(context.outputFolder() / kFlatteningState);
  Made made;
  made.state.uncut = flattening::sumOver(disc);
  if (s.cuts == kAutomatic) {
    auto step = context.step("cut");
    Opened opened = openedByItself(context, context.monitor(), subject.reference, disc, s.cut,
                                   from ? &*from : nullptr);
    made.state.cuts = std::move(opened.plan);
    if (made.state.cuts->termination == Termination::Interrupted) return made;
    disc = std::move(opened.disc);
  }
  if (subject.cuts) {
    auto step = context.step("cut");
    disc = openedAlongTemplate(context, subject.reference, disc, *subject.cuts);
  }
  made.secondsCut = seconds();
  auto step = context.step("flatten");
  try {
    made.map = flattening::flatten(disc, options, context.monitor(), from ? &from->map : nullptr);
  } catch (const Interrupted&) {
    if (!made.state.cuts) throw;
    step.termination(causeOf(Termination::Interrupted));
    return made;
  }
  made.map.termination = causeOf(made.map.termination);
  step.iterations(made.map.iterations);
  step.termination(made.map.termination);
  made.state.map = std::move(made.map.state);
  made.disc = std::move(disc);
  return made;
}

Termination run(Context& context, const FlattenSettings& s) {
  const Stopwatch seconds;
  const Subject subject = subjectOf(context, s);
  const std::optional<Cortex> surfaces = checkBeside(context, s, subject);
  flattening::Disc whole = flattening::discOf(subject.reference.mesh, subject.faces);
  sayHowRead(context, subject.reference.origin);
  flattening::FlattenOptions options = s.flatten;
  options.areaTolerance = s.areaTolerance.value_or(s.cuts ? kCutTolerance : kPatchTolerance);
  const double read = seconds();
  // What comes after cuts and map, in times of the start, which reads one surface.
  constexpr double kRest = 2, kEachFrame = 0.5;
  const TimeKept rest(read * (kRest + kEachFrame * options.frames));
  const Made made = make(context, s, subject, std::move(whole), options);
  const StopScope kept(nullptr);  // what is reached is written
  flattening::writeCheckpoint(context.output(kFlatteningState), made.state);
  if (!made.hasMap()) return Termination::Interrupted;
  const flattening::Disc& disc = made.disc;
  const flattening::FlatMap& map = made.map;
  const double flattened = seconds();
  warnOf(context, disc, map);
  auto step = context.step("measure and write");
  const TriangleMesh flat{patchPositions(map), disc.mesh.faces};
  writeSurfaces(context, subject, disc, map, wholeMap(subject.reference.mesh, disc, map.positions));
  unfolding::FlatSummary summary;
  summary.disc = &disc;
  summary.map = &map;
  summary.area = geometry::totalArea(disc.mesh);
  summary.areaTolerance = options.areaTolerance;
  summary.turnedOverInFrames = writeFrames(context, subject, disc, map.frames);
  Termination termination = map.termination;
  const Eigen::VectorXd areaRatio = measure(context, subject, disc, flat, summary, termination);
  describing(context, termination, [&] {
    writePatchTable(context, s, subject, disc, map, areaRatio);
    writeGrid(context, s, surfaces, disc, flat);
  });
  context.results(summary);
  sayWhetherUsable(context, map);
  context.result("seconds_start", read);
  context.result("seconds_cut", made.secondsCut);
  context.result("seconds_flatten", flattened - read - made.secondsCut);
  context.result("seconds_output", seconds() - flattened);
  const bool folded = map.turnedOver > 0 || map.rimCrossings > 0;
  return folded ? Termination::Stalled : termination;
}

}  // namespace

Command flattenCommand() {
  return makeCommand<FlattenSettings>("flatten", declare, run);
}

}  // namespace explica::app
