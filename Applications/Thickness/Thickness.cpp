// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Correspondence/AnatomicalGrid.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/Layers.h"
#include "Explica/Correspondence/Sulci.h"
#include "Explica/Correspondence/Ventricle.h"
#include "Explica/Harmonic/Annulus.h"
#include "Explica/Harmonic/Interpolant.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/IO/VtkFile.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace explica::app {

enum class SulciMode {
  Recover,  ///< put the outer boundary between banks that touch
  Ignore    ///< take the labels as they are
};

}  // namespace explica::app

template <>
struct explica::EnumNames<explica::app::SulciMode> {
  static constexpr std::array table{std::pair{explica::app::SulciMode::Recover, "recover"},
                                    std::pair{explica::app::SulciMode::Ignore, "ignore"}};
};

namespace explica::app {
namespace {

struct Settings {
  std::optional<std::string> labels;
  std::optional<std::string> innerLevel;
  std::optional<std::string> outerLevel;
  harmonic::LevelOptions level;
  io::VolumeReadOptions reading;
  harmonic::LabelRoles roles;
  harmonic::AnnulusOptions annulus;
  harmonic::InterpolantOptions interpolant;
  SulciMode sulci = SulciMode::Recover;
  correspondence::SulcusOptions sulcus;
  correspondence::CorrespondenceOptions correspondence;
  correspondence::LayerOptions layers;
  std::optional<int> grid;
  bool aha = false;
  std::optional<Eigen::Vector3d> rvInsertion;
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("thickness, depth and layers of the tissue between two boundaries")
      .description(
          "Solves Laplace's equation between the inner and the outer boundary of a tissue such as "
          "cortex or heart muscle, follows the field lines that join the boundaries, and measures "
          "along them. The boundary lies between voxel centres: where level sets cross, or where a "
          "smooth surface fits the labels. Sulci whose banks touch are opened first.")
      .reference("Jones, Buchbinder, Aharon 2000, Human Brain Mapping 11:12-32")
      .reference("Yezzi, Prince 2003, IEEE Trans. Med. Imaging 22(10):1332-1339")
      .reference("Rocha, Yezzi, Prince 2007, IEEE Trans. Image Processing 16(3):636-648")
      .example("explica thickness seg.nii.gz --inner 3 --tissue 2 --out thickness",
               "Grey matter between white matter (3) and all other labels")
      .example("explica thickness ED_label.nii.gz --inner 1 --tissue 2 --per-slice --out wall",
               "Heart wall, every short-axis slice on its own")
      .input("SEG", FileKind::LabelVolume,
             "label volume; with level sets it may be left out, or say what is insulated", s.labels)
      .inputOption("inner-level", FileKind::Volume,
                   "scalar volume whose level --level is the inner boundary", s.innerLevel)
      .inputOption("outer-level", FileKind::Volume,
                   "scalar volume whose level --level is the outer boundary", s.outerLevel)
      .option("Inputs", Field{"level", "", "value of the level sets on the boundary"},
              s.level.level)
      .option("Inputs", Field{"level-inside", "", "side of the level sets that is enclosed"},
              s.level.inside)
      .options("Reading", s.reading)
      .options("Labels", s.roles)
      .options("Boundary", s.annulus)
      .option("Boundary", Field{"sulci", "", "what to do where the banks of a sulcus touch"},
              s.sulci)
      .options("Boundary", s.sulcus)
      .options("Correspondences", s.correspondence)
      .options("Layers", s.layers)
      .option("Layers", Field{"grid", "", "write an anatomical grid with this many cells across"},
              s.grid)
      .option("Heart", Field{"aha", "", "table and picture of the left ventricle's 17 segments"},
              s.aha)
      .option("Heart",
              Field{"rv-insertion", "mm", "anterior insertion of the right ventricle, RAS"},
              s.rvInsertion)
      .output("harmonic.nii.gz", FileKind::Volume,
              "u: 0 at the inner boundary to 1 at the outer one")
      .output("thickness.nii.gz", FileKind::Volume,
              "length of the trajectory, mm; 0 off the tissue")
      .output("inner_distance.nii.gz", FileKind::Volume, "L0: length to the inner boundary, mm")
      .output("outer_distance.nii.gz", FileKind::Volume, "L1: length to the outer boundary, mm")
      .output("depth.nii.gz", FileKind::Volume, "L0 / thickness")
      .output("inner_point.nii.gz", FileKind::PointVolume,
              "phi0: corresponding point of the inner boundary, RAS mm")
      .output("outer_point.nii.gz", FileKind::PointVolume,
              "phi1: corresponding point of the outer boundary, RAS mm")
      .output("layers.nii.gz", FileKind::LabelVolume, "layer, 1 at the inner boundary")
      .output("grid.vtu", FileKind::Grid,
              "with --grid: points at equal depths along trajectories, with depth and thickness")
      .output("segments.tsv", FileKind::Table, "with --aha: thickness of the 17 segments")
      .output("segments.nii.gz", FileKind::LabelVolume, "with --aha: segment of each voxel")
      .output("bullseye.svg", FileKind::Picture, "with --aha: the segments' mean thickness, mm")
      .output("sulci.nii.gz", FileKind::LabelVolume,
              "with --sulci recover: 1 where a boundary was put beside a voxel");
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

harmonic::Annulus readAnnulus(Context& context, const Settings& s) {
  if (s.innerLevel.has_value() != s.outerLevel.has_value()) {
    throw UsageError("--inner-level and --outer-level belong together; one of them is missing");
  }
  if (!s.labels && !s.innerLevel) {
    throw UsageError("give a label volume, or --inner-level and --outer-level");
  }
  if (s.aha && !s.rvInsertion) throw UsageError("--aha needs --rv-insertion X,Y,Z");
  Volume<Label> labels;
  if (s.labels) labels = readLabels(context, "SEG", *s.labels, s.reading);
  Volume<float> inner, outer;
  if (s.innerLevel) {
    inner = readScalars(context, "inner-level", *s.innerLevel, s.reading);
    outer = readScalars(context, "outer-level", *s.outerLevel, s.reading);
  }
  auto step = context.step("boundary");
  if (!s.innerLevel) {
    return harmonic::annulusFromLabels(labels, s.roles, s.annulus, context.monitor());
  }
  Volume<std::uint8_t> insulated;
  if (s.labels) insulated = harmonic::maskOf(labels, s.roles.insulated);
  return harmonic::annulusFromLevels(inner, outer, s.level, s.annulus, insulated,
                                     context.monitor());
}

/// Mean and percentiles of the finite values.
void reportThickness(Context& context, const correspondence::Correspondence& found) {
  const correspondence::ThicknessSummary t = correspondence::summaryOf(found);
  context.result("thickness_mean", t.mean);
  context.result("thickness_median", t.median);
  context.result("thickness_p05", t.p05);
  context.result("thickness_p95", t.p95);
}

Termination run(Context& context, const Settings& s) {
  harmonic::Annulus annulus = readAnnulus(context, s);
  context.result("voxels", annulus.count());
  context.result("components", annulus.components);
  context.result("direct_contacts", annulus.directContacts);
  context.result("voxels_left_out", annulus.droppedVoxels);

  Volume<Label> sulci;
  if (s.sulci == SulciMode::Recover) {
    auto step = context.step("sulci");
    auto recovered = correspondence::recoverSulci(annulus, s.sulcus, context.monitor());
    annulus = std::move(recovered.annulus);
    context.result("sulcal_voxels_recovered", recovered.voxels.size());
    sulci = harmonic::maskOf(annulus, recovered.voxels);
  } else {
    context.result("sulcal_voxels_recovered", 0);
  }

  double begin = seconds();
  harmonic::Interpolant interpolant;
  {
    auto step = context.step("harmonic");
    interpolant = harmonic::solveInterpolant(annulus, s.interpolant, context.monitor());
    step.iterations(interpolant.iterations);
    step.termination(interpolant.termination);
  }
  context.result("seconds_harmonic", seconds() - begin);
  context.result("residual", interpolant.relativeResidual);
  context.result("iterations", interpolant.iterations);

  begin = seconds();
  correspondence::Correspondence found;
  {
    auto step = context.step("correspondence");
    found = correspondence::findCorrespondences(annulus, interpolant, s.correspondence,
                                                context.monitor());
  }
  context.result("seconds_correspondence", seconds() - begin);
  context.result("traced_fraction",
                 static_cast<double>(found.traced) / (2.0 * static_cast<double>(annulus.count())));
  context.result("voxels_without_thickness", found.missing);
  if (found.missing > 0) {
    context.warn(std::to_string(found.missing) +
                 " voxels have no thickness: their trajectory does not reach both boundaries");
  }
  reportThickness(context, found);

  std::vector<double> depth;
  std::vector<int> layers;
  {
    auto step = context.step("layers");
    depth = correspondence::depthOf(found);
    layers =
        correspondence::layersOf(s.layers.layerKind == correspondence::LayerKind::Depth
                                     ? depth
                                     : correspondence::volumeDepthOf(annulus, interpolant, found),
                                 s.layers.layers);
  }

  correspondence::AnatomicalGrid grid;
  if (s.grid) {
    auto step = context.step("grid");
    grid = correspondence::anatomicalGrid(annulus, interpolant, *s.grid);
    context.result("grid_trajectories", grid.trajectories);
    context.result("grid_cells", static_cast<std::size_t>(grid.cells.rows()));
  }
  correspondence::WallSegments segments;
  if (s.aha) segments = correspondence::wallSegments(annulus, found, *s.rvInsertion);

  auto step = context.step("write");
  const auto write = [&](const char* name, const std::vector<double>& values) {
    io::writeVolume(context.output(name), harmonic::spread(annulus, values));
  };
  io::writeVolume(context.output("harmonic.nii.gz"),
                  harmonic::spread(annulus, interpolant.u, 0, 0, 1));
  write("thickness.nii.gz", correspondence::thicknessOf(found));
  write("inner_distance.nii.gz", found.innerDistance);
  write("outer_distance.nii.gz", found.outerDistance);
  write("depth.nii.gz", depth);
  io::writeVolume(context.output("inner_point.nii.gz"),
                  correspondence::spreadPoints(annulus, found.innerPoint));
  io::writeVolume(context.output("outer_point.nii.gz"),
                  correspondence::spreadPoints(annulus, found.outerPoint));
  io::writeVolume(context.output("layers.nii.gz"), harmonic::spreadLabels(annulus, layers));
  if (s.grid) {
    const auto kind = grid.cells.cols() == 8 ? io::CellKind::Hexahedron : io::CellKind::Quad;
    io::writeVtu(context.output("grid.vtu"), grid.points, {{kind, grid.cells}},
                 {{"depth", "", grid.depth}, {"thickness", "mm", grid.thickness}});
  }
  if (s.aha) {
    writeTextFile(context.output("segments.tsv"), correspondence::tableOf(segments));
    writeTextFile(context.output("bullseye.svg"), correspondence::bullseyeOf(segments));
    io::writeVolume(context.output("segments.nii.gz"),
                    harmonic::spreadLabels(annulus, segments.segmentOf));
  }
  if (sulci.size() > 0) io::writeVolume(context.output("sulci.nii.gz"), sulci);
  return interpolant.termination;
}

}  // namespace

Command thicknessCommand() {
  return makeCommand<Settings>("thickness", declare, run);
}

}  // namespace explica::app
