// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Plausible.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Correspondence/Measurement.h"
#include "Explica/Harmonic/Annulus.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/IO/VtkFile.h"
#include "Explica/Provenance/Doubts.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace explica::app {

namespace {

struct ThicknessSettings {
  std::optional<std::string> labels;
  std::optional<std::string> innerLevel;
  std::optional<std::string> outerLevel;
  harmonic::LevelOptions level;
  io::VolumeReadOptions reading;
  harmonic::LabelRoles roles;
  correspondence::MeasurementOptions measurement;
  std::vector<std::string> accept;
};

void declareThicknessOutputs(Declaration& d) {
  d.output("harmonic.nii.gz", FileKind::Volume, "u: 0 at the inner boundary to 1 at the outer one")
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
              "with --cells: points at equal depths along trajectories, with depth and thickness; "
              "of slices on their own their contours")
      .output("valid.nii.gz", FileKind::LabelVolume,
              "1 where thickness is known and the image's edge does not reach it")
      .output("sulci.nii.gz", FileKind::LabelVolume,
              "where sulci are recovered: 1 beside a boundary that was put between banks");
}

void declare(Declaration& d, ThicknessSettings& s) {
  d.synopsis("thickness, depth and layers of the tissue between two boundaries")
      .description(
          R"(Solves Laplace's equation between the inner and the outer boundary of a tissue such as cortex or heart muscle, follows the field lines that join the boundaries, and measures along them. The boundary lies between voxel centres: where level sets cross, or where a smooth surface fits the labels. Sulci whose banks touch are opened first.)")
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
      .category("Inputs")
      .option("level", "value of the level sets on the boundary", s.level.level)
      .option("level-inside", "side of the level sets that is enclosed", s.level.inside)
      .options("Reading", s.reading)
      .options("Labels", s.roles)
      .options("Boundary", s.measurement.annulus)
      .category("Boundary")
      .option(
          "sulci",
          R"(what to do where the banks of a sulcus touch (default: recover; ignore with --open-ends, which is for hearts, and with --per-slice where the inner region is not folded as a cortex's))",
          s.measurement.sulci)
      .options("Boundary", s.measurement.sulcus)
      .options("Correspondences", s.measurement.correspondence)
      .options("Layers", s.measurement.layers)
      .category("Layers")
      .option({"cells", "", "write an anatomical grid with this many cells across", 1, 1000},
              s.measurement.grid)
      .excludes("inner-level", {"inner", "tissue", "outer"})
      .needs({"level", "level-inside"}, {"inner-level"});
  declareAccept(d, s.accept);
  declareThicknessOutputs(d);
  d.results<correspondence::Measurement>();
}

harmonic::Annulus readAnnulus(Context& context, const ThicknessSettings& s) {
  if (s.innerLevel.has_value() != s.outerLevel.has_value()) {
    throw UsageError("--inner-level and --outer-level belong together; one of them is missing");
  }
  if (!s.labels && !s.innerLevel) {
    throw UsageError("give a label volume, or --inner-level and --outer-level");
  }
  Volume<Label> labels;
  if (s.labels) labels = readTissueLabels(context, "SEG", *s.labels, s.reading);
  Volume<float> inner, outer;
  if (s.innerLevel) {
    inner = readScalars(context, "inner-level", *s.innerLevel, s.reading);
    outer = readScalars(context, "outer-level", *s.outerLevel, s.reading);
  }
  auto step = context.step("boundary");
  if (!s.innerLevel) {
    return harmonic::annulusFromLabels(std::move(labels), s.roles, s.measurement.annulus,
                                       context.monitor());
  }
  Volume<std::uint8_t> insulated;
  if (s.labels) insulated = harmonic::maskOf(labels, s.roles.insulated);
  return harmonic::annulusFromLevels(inner, outer, s.level, s.measurement.annulus, insulated,
                                     context.monitor());
}

/// The measurement, each part a step of the record.
correspondence::Measurement measure(Context& context, harmonic::Annulus annulus,
                                    const correspondence::MeasurementOptions& options) {
  std::optional<Context::Step> step;
  const Stopwatch seconds;
  double begin = 0;
  std::string current;
  const auto onPart = [&](const std::string& part, const correspondence::Measurement& sofar) {
    if (current == "harmonic") {
      step->iterations(sofar.interpolant.iterations);
      step->termination(sofar.interpolant.termination);
    }
    if (current == "harmonic" || current == "correspondence") {
      context.result("seconds_" + current, seconds() - begin);
    }
    step.reset();
    step.emplace(context, part);
    begin = seconds();
    current = part;
  };
  return correspondence::measure(std::move(annulus), options, context.monitor(), onPart);
}

void report(Context& context, Judge& judge, const correspondence::Measurement& m) {
  context.results(m);
  // Slices on their own always leave out what lies beyond the inner region's ends.
  const double leftOut = m.annulus.planar ? 0 : static_cast<double>(m.annulus.droppedVoxels);
  judge.flag("without-thickness", (static_cast<double>(m.lost) + leftOut) /
                                      (static_cast<double>(m.annulus.count()) + leftOut));
  if (m.cutVoxels > 0) {
    context.warn(std::to_string(m.cutVoxels) +
                 " voxels lie so near to the image's edge that their thickness holds only if it "
                 "cuts the tissue at right angles (0 in valid.nii.gz)");
  }
}

void writeOutputs(Context& context, const correspondence::Measurement& m, bool sulci) {
  auto step = context.step("write");
  const correspondence::Correspondence& found = m.correspondence;
  std::vector<std::function<void()>> files;
  const auto write = [&](const char* name, auto volume) {
    files.push_back([path = context.output(name), volume = std::move(volume)] {
      io::writeVolume(path, volume);
    });
  };
  write("harmonic.nii.gz", harmonic::spread(m.annulus, m.interpolant.u, 0, 0, 1));
  write("thickness.nii.gz", harmonic::spread(m.annulus, correspondence::thicknessOf(found)));
  write("inner_distance.nii.gz", harmonic::spread(m.annulus, found.innerDistance));
  write("outer_distance.nii.gz", harmonic::spread(m.annulus, found.outerDistance));
  write("depth.nii.gz", harmonic::spread(m.annulus, m.depth));
  write("inner_point.nii.gz", harmonic::spreadPoints(m.annulus, found.innerPoint));
  write("outer_point.nii.gz", harmonic::spreadPoints(m.annulus, found.outerPoint));
  write("layers.nii.gz", harmonic::spreadLabels(m.annulus, m.layers));
  write("valid.nii.gz", harmonic::spreadLabels(m.annulus, correspondence::validOf(m)));
  if (sulci) write("sulci.nii.gz", harmonic::maskOf(m.annulus, m.sulcalVoxels));
  parallelFor(files.size(), 1, [&](std::size_t f) { files[f](); });
}

void writeGrid(Context& context, const correspondence::AnatomicalGrid& grid) {
  auto step = context.step("grid");
  const auto kind = grid.cells.cols() == 8 ? io::CellKind::Hexahedron : io::CellKind::Quad;
  io::writeVtu(context.output("grid.vtu"), grid.points, {{kind, grid.cells}},
               {{"depth", "", grid.depth}, {"thickness", "mm", grid.thickness}});
}

Termination run(Context& context, const ThicknessSettings& s) {
  Judge judge(context, s.accept);
  harmonic::Annulus annulus = readAnnulus(context, s);
  const std::size_t atBorder = harmonic::countAtImageBorder(annulus);
  context.doubt(provenance::kTissueAtImageBorder, atBorder,
                std::to_string(atBorder) + " of " + std::to_string(annulus.count()) +
                    " tissue voxels lie in the image's outermost layer, which may cut the tissue");
  const correspondence::Measurement m = measure(context, std::move(annulus), s.measurement);
  report(context, judge, m);
  writeOutputs(context, m, m.sulciRecovered);
  if (m.grid) writeGrid(context, *m.grid);
  return m.interpolant.termination;
}

}  // namespace

Command thicknessCommand() {
  return makeCommand<ThicknessSettings>("thickness", declare, run);
}

}  // namespace explica::app
