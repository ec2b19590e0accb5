// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "CortexRegions.h"
#include "Explica/Application/Command.h"
#include "Explica/Application/Plausible.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Surface/GivenSurfaces.h"
#include "Explica/Surface/Summary.h"
#include "Files.h"
#include "Settings.h"
#include "Tissue.h"

#include <algorithm>
#include <array>
#include <utility>

namespace explica::app {
namespace {

void checkChoice(const SurfaceSettings& s) {
  constexpr double kMostScale = 1e3;  // from metres to millimetres
  if (!(s.scale >= 1 / kMostScale && s.scale <= kMostScale)) {
    throw UsageError("surface: --scale is a factor between 0.001 and 1000");
  }
  if (s.scale != 1 && surfacesGiven(s)) {
    throw UsageError("surface: --scale is of volumes; given surfaces have their own lengths");
  }
  const int sources = s.segmentation.has_value() + s.innerLevel.has_value() + surfacesGiven(s);
  if (sources != 1) {
    throw UsageError("surface: give one of SEG, --inner-level and --white-surface");
  }
  if (surfacesGiven(s) && !(s.whiteSurface && s.pialSurface)) {
    throw UsageError("surface: --white-surface and --pial-surface go together");
  }
  if (s.image && surfacesGiven(s)) {
    throw UsageError("surface: --image places borders that are made, not those of --white-surface");
  }
  if (s.parcellation && !surfacesGiven(s)) {
    throw UsageError("surface: --parcellation belongs to the vertices of --white-surface");
  }
}

/// Surfaces of another program, as they are; they must bound a volume, whatever their topology.
surface::CorticalSurfaces readGivenSurfaces(Context& context, const SurfaceSettings& s,
                                            std::string& structure) {
  const auto read = [&](const char* name, const std::string& path) {
    io::LoadedSurface loaded =
        readSurface(context, name, path, {.space = s.surfaceSpace, .fsVolume = s.fsVolume});
    geometry::requireClosedManifold(loaded.mesh, path);
    if (structure == "Cortex" && loaded.metadata.structure != "Other") {
      structure = loaded.metadata.structure;
    }
    sayHowRead(context, loaded.origin);
    return std::move(loaded.mesh);
  };
  structure = "Cortex";
  TriangleMesh white = read("white-surface", *s.whiteSurface);
  TriangleMesh pial = read("pial-surface", *s.pialSurface);
  std::optional<TriangleMesh> mid;
  if (s.midSurface) mid = read("mid-surface", *s.midSurface);
  if (s.tissue.hemisphere) {
    structure = *s.tissue.hemisphere == surface::Side::Left ? "CortexLeft" : "CortexRight";
  }
  return surface::adoptSurfaces(std::move(white), std::move(pial), std::move(mid));
}

/// What a reader must know of a sheet, and of an image that shows too little to be the labels'.
void warnOf(Context& context, const surface::CorticalSurfaces& made, bool hasImage) {
  const std::int64_t cut = made.sheet.cutByImage;
  if (cut > 0) {
    context.warn(std::to_string(cut) + " of " + std::to_string(made.thickness.size()) +
                 " vertices lie so near to the image's edge that their thickness holds only if it "
                 "cuts the tissue at right angles (0 in valid.shape.gii)");
  }
  constexpr double kFewest = 0.5;  // share of vertices with an edge
  const auto vertices = static_cast<double>(made.thickness.size() - made.noRibbon);
  const std::int64_t missing = made.image.missingWhite - made.noRibbon;
  if (hasImage && static_cast<double>(missing) > (1 - kFewest) * vertices) {
    context.warn("the image shows no edge of white matter at " + std::to_string(missing) +
                 " vertices: is it the image of these labels?");
  }
}

surface::SurfaceSummary summaryOf(const SurfaceSettings& s, const surface::CorticalTissue& tissue,
                                  const surface::CorticalSurfaces& made) {
  surface::SurfaceSummary summary;
  summary.regions.reset();
  summary.cerebrumVolume.reset();
  summary.given = surfacesGiven(s);
  summary.tissue = &tissue;
  summary.made = &made;
  summary.hasGrey = tissue.hasGrey;
  summary.bareShare.reset();
  if (tissue.hasGrey && tissue.white.size() > 0) summary.bareShare = surface::bareShare(tissue);
  summary.hasImage = s.image.has_value();
  const std::array meshes = {&made.white.mesh, &made.mid, &made.pial};
  parallelFor(tissue.hasGrey ? 3 : 1, 1,
              [&](std::size_t n) { summary.checks[n] = surface::checkOf(*meshes[n]); });
  const Eigen::VectorXd angles = geometry::smallestAnglesRad(made.white.mesh);
  std::vector<double> sorted(angles.begin(), angles.end());
  summary.smallestAngleDeg = nthSmallest(sorted, sorted.size() / 20) * 180 / kPi;
  summary.thickness.reset();
  if (tissue.hasGrey) {
    summary.thickness =
        surface::thicknessMeansOf(made, s.thicknessMeasure == ThicknessMeasure::Nearest);
  }
  return summary;
}

/// The volume whose surface RAS FreeSurfer files use.
std::optional<Grid> freeSurferGrid(const SurfaceSettings& s, const TissueInputs& inputs) {
  if (s.fsVolume) {
    Grid grid = io::readGrid(*s.fsVolume);
    grid.spacing *= s.scale;
    grid.origin *= s.scale;
    return grid;
  }
  const surface::LabelPreset preset = inputs.tissue.preset;
  if (preset == surface::LabelPreset::Aseg || preset == surface::LabelPreset::Ribbon ||
      preset == surface::LabelPreset::Wm) {
    return inputs.grid;
  }
  return {};
}

Termination run(Context& context, const SurfaceSettings& s) {
  checkChoice(s);
  Judge judge(context, s.accept);
  const bool given = surfacesGiven(s);
  TissueInputs inputs;
  surface::CorticalSurfaces made;
  for (const auto* file :
       {&s.image, &s.t2, &s.fsVolume}) {  // read later: whether it can be is said now
    if (*file) static_cast<void>(io::readGrid(**file));
  }
  if (given) made = readGivenSurfaces(context, s, inputs.tissue.structure);
  const CortexRegions regions = readRegions(context, s, made);
  if (!given) inputs = readTissue(context, s);
  const surface::CorticalTissue& tissue = inputs.tissue;
  if (inputs.block && s.image) {
    throw UsageError("surface: --image places the borders of closed surfaces, not of sheets");
  }
  const std::optional<Grid> fsGrid = freeSurferGrid(s, inputs);
  SurfaceImages images;
  if (!given) {
    images = readImages(context, s);
    made = makeSurfaces(context, s, inputs, images);
  }
  const std::vector<WrittenSurface> surfaces = namedSurfaces(made, tissue.hasGrey);
  surface::SurfaceSummary summary;
  {
    auto step = context.step("check");
    summary = summaryOf(s, tissue, made);
    summary.secondMoved = images.secondMoved;
  }
  {
    auto step = context.step("write");
    writeMaps(context, s, made, tissue, surfaces, regions, summary);
    writeTextFile(context.output("topology.tsv"), defectTable(made.white.defects));
    if (s.freeSurfer) writeFreeSurfer(context, s, made, tissue, surfaces, fsGrid);
  }
  if (!given) {
    doubtLabels(context, tissue, made.sheet.open);
    checkVolume(context, made, tissue, summary);
  }
  warnOf(context, made, summary.hasImage && tissue.hasGrey);
  context.results(summary);
  if (!given) {
    judge.flag("corrected", made.white.correctedShare);
    if (summary.bareShare) judge.flag("exchanged", *summary.bareShare);
  }
  // Labels named by hand need not be a cortex's.
  if (tissue.hasGrey && s.tissue.white.empty()) {
    judge.flag("thickness-mean", surface::meanThickness(made.columns.area, made.columns.thickness));
  }
  const std::int64_t meetings = summary.meetings();
  if (!given && meetings > 0) {
    context.warn("the surfaces meet themselves at " + std::to_string(meetings) + " pairs of faces");
    return Termination::Stalled;
  }
  return Termination::Finished;
}

}  // namespace

Command surfaceCommand() {
  return makeCommand<SurfaceSettings>("surface", declareSurface, run);
}

}  // namespace explica::app
