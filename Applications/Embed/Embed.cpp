// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Coefficients.h"
#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Application/ReadPolygon.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Document.h"
#include "Explica/Shapes/ShapeFit.h"
#include "Explica/Shapes/ShapeLevel.h"
#include "Explica/Shapes/Summary.h"

#include <algorithm>
#include <cmath>

namespace explica::app {
namespace {

struct EmbedSettings {
  std::vector<std::string> targets;
  bool fit = false;
  bool average = false;
  std::vector<double> weights;
  PolygonReading reading;
  shapes::AnnulusOptions annulus;
  int grid = 96;
  int frames = 6;
  shapes::ShapeFitOptions fitting;
};

void declare(Declaration& d, EmbedSettings& s) {
  d.synopsis("closed shapes as harmonic functions: fitted, averaged, combined")
      .description(
          R"(A closed curve or surface in an annulus is the 1/2 level of a harmonic function, and its coefficients can be averaged and combined: every convex combination is again one closed shape. Targets are polygons (CSV), label images (with --label-key), surfaces, or coefficients.json of an earlier run; all share one annulus between circles or spheres around the targets. Details finer than the distance to its boundaries cannot be met: a narrower annulus follows the targets more closely.)")
      .reference("Duci, Yezzi, Soatto, Rocha 2006, J. Mathematical Imaging and Vision 25:341-352")
      .example("explica embed contour.csv --fit --out fit", "Coefficients of a contour")
      .example("explica embed a.csv b.csv --average --out mean", "Mean shape of two contours")
      .example("explica embed a.surf.gii b.surf.gii --combine 0.3,0.7 --out mix",
               "Between two surfaces")
      .example("explica embed ED_label.nii.gz --label-key 2 --out muscle",
               "The outer contour of the heart muscle")
      .input("TARGET", FileKind::Any, "polygons, label images, surfaces or coefficients.json",
             s.targets)
      .category("Shape")
      .option("fit", "fit a single target (default for one target)", s.fit)
      .option("average", "mean of the targets (default for several)", s.average)
      .option("combine", "weights of the targets, one each", s.weights);
  declarePolygonReading(d, s.reading);
  d.options("Annulus", s.annulus)
      .options("Fit", s.fitting)
      .category("Output")
      .option({"cells", "", "voxels per side, for drawing the shape", 16, 1024}, s.grid)
      .option({"frames", "", "states of the first target's fit", 0, 1000}, s.frames)
      .output("coefficients.json", FileKind::JsonFile, "the shape's coefficients")
      .output("field.nii.gz", FileKind::Volume, "in 3D: u on the grid; the shape is its 1/2 level")
      .output("shape.csv", FileKind::Polygon, "in 2D: the shape")
      .output("shape.surf.gii", FileKind::Surface, "in 3D: the shape")
      .output("fit.tsv", FileKind::Table, "one row a target and iteration")
      .output("frames/frame-*.csv", FileKind::Polygon,
              "in 2D: from the initial estimate to the fit")
      .output("frames/frame-*.surf.gii", FileKind::Surface, "in 3D: the same")
      .results<shapes::EmbedSummary>();
}

/// A target as it was read: one of the three.
struct EmbedTarget {
  std::optional<shapes::HarmonicShape> shape;
  std::optional<planar::Curve> curve;
  std::optional<TriangleMesh> mesh;

  [[nodiscard]] int dimension() const { return shape ? shape->annulus.dimension : (curve ? 2 : 3); }
};

EmbedTarget readTarget(Context& context, const std::string& path, const PolygonReading& reading) {
  EmbedTarget target;
  if (path.ends_with(".json")) {
    target.shape = readCoefficients(path);
  } else if (isPolygonTable(path)) {
    target.curve = readCurve(context, "TARGET", path, {});
  } else if (reading.label) {
    target.curve = readCurve(context, "TARGET", path, reading);
  } else {
    target.mesh = io::readSurface(path).mesh;
  }
  return target;
}

shapes::HarmonicAnnulus annulusFor(const EmbedSettings& s, const std::vector<EmbedTarget>& targets,
                                   const std::vector<shapes::TargetSamples>& samples) {
  const int dimension = targets.front().dimension();
  for (const EmbedTarget& t : targets) {
    if (t.dimension() != dimension) {
      throw InvalidInput("targets in the plane and in space cannot be mixed");
    }
  }
  for (const EmbedTarget& t : targets) {
    if (t.shape) return t.shape->annulus;  // for all
  }
  return shapes::annulusAround(samples, dimension, s.annulus);
}

void writeShape(Context& context, const std::string& stem, const shapes::HarmonicShape& shape,
                int grid) {
  if (shape.annulus.dimension == 2) {
    io::writePolygonCsv(context.output(stem + ".csv"),
                        shapes::levelCurves(shape, grid).front().positions);
  } else {
    io::writeGiftiSurface(context.output(stem + ".surf.gii"), shapes::levelSurface(shape, grid));
  }
}

/// Writes `frames` states of a fit, from the initial estimate on.
void writeEvolution(Context& context, const EmbedSettings& s, const shapes::ShapeFit& fit) {
  const std::size_t last = fit.path.size() - 1;
  const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(s.frames), last + 1);
  for (std::size_t f = 0; f < count; ++f) {
    // Early iterations move most: their frames lie closer together.
    const double share = count > 1 ? static_cast<double>(f) / static_cast<double>(count - 1) : 1;
    const auto even =
        static_cast<std::size_t>(std::lround(share * share * static_cast<double>(last)));
    const std::size_t at = std::max(even, std::min(f, last));
    const int grid = fit.shape.annulus.dimension == 2 ? s.grid : std::max(16, s.grid / 2);
    writeShape(context, frameName(f, ""), fit.path[at], grid);
  }
}

/// Distances both ways between the fitted shape and its target.
void measureDistance(const shapes::HarmonicShape& shape, const EmbedTarget& target, int grid,
                     shapes::EmbedSummary& summary) {
  shapes::LevelDistance there;
  shapes::LevelDistance back;
  if (target.curve) {
    const planar::Curve curve = shapes::levelCurves(shape, grid).front();
    there = shapes::distanceBetween(curve, *target.curve);
    back = shapes::distanceBetween(*target.curve, curve);
  } else if (target.mesh) {
    const TriangleMesh mesh = shapes::levelSurface(shape, grid);
    there = shapes::distanceBetween(mesh, *target.mesh);
    back = shapes::distanceBetween(*target.mesh, mesh);
  } else {
    return;
  }
  summary.distanceMean = std::max(there.mean, back.mean);
  summary.distanceMax = std::max(there.max, back.max);
}

/// What the targets become in the annulus, and how well, iteration by iteration, as a table.
struct Fits {
  std::vector<shapes::HarmonicShape> shapes;
  std::string table = "target\titeration\tsymmetric_difference\tdistance_mean\tdistance_max\n";
  Termination termination = Termination::NotRun;  ///< of the last, or the first that fell short
  Change symmetricDifference;                     ///< of the first target, if it was fitted
};

void appendRows(std::string& table, std::size_t target, const shapes::ShapeFit& fit) {
  for (std::size_t i = 0; i < fit.history.size(); ++i) {
    table += printed("%zu\t%zu\t%.9g\t%.9g\t%.9g\n", target, i, fit.history[i].symmetricDifference,
                     fit.history[i].distanceMean, fit.history[i].distanceMax);
  }
}

/// Targets that are shapes already stay as they are; `samples` are of the others, in their order.
Fits fitAll(Context& context, const EmbedSettings& s, const std::vector<EmbedTarget>& targets,
            const std::vector<shapes::TargetSamples>& samples,
            const shapes::HarmonicAnnulus& annulus) {
  auto step = context.step("fit");
  Fits fits;
  std::size_t next = 0;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (targets[k].shape) {
      fits.shapes.push_back(*targets[k].shape);
      continue;
    }
    const shapes::ShapeFit fit =
        shapes::fitShape(annulus, samples[next++], s.fitting, context.monitor());
    fits.shapes.push_back(fit.shape);
    if (fits.termination == Termination::NotRun || !reachedGoal(fit.termination)) {
      fits.termination = fit.termination;
    }
    appendRows(fits.table, k, fit);
    if (k > 0) continue;
    if (s.frames > 0) writeEvolution(context, s, fit);
    fits.symmetricDifference = {fit.history.front().symmetricDifference,
                                fit.history.back().symmetricDifference};
  }
  step.termination(fits.termination);
  return fits;
}

Termination run(Context& context, const EmbedSettings& s) {
  const int asked = int{s.fit} + int{s.average} + int{!s.weights.empty()};
  if (asked > 1) throw UsageError("give one of --fit, --average and --combine");
  if (s.fit && s.targets.size() != 1) throw UsageError("--fit takes one target");
  if (s.grid < 16 || s.fitting.samples < 16 || s.frames < 0) {
    throw UsageError("--cells and --samples need at least 16, --frames at least 0");
  }
  std::vector<EmbedTarget> targets;
  std::vector<shapes::TargetSamples> samples;
  for (const std::string& path : s.targets) {
    targets.push_back(readTarget(context, path, s.reading));
    const EmbedTarget& t = targets.back();
    if (t.curve) samples.push_back(shapes::samplesOf(*t.curve, s.fitting.samples));
    if (t.mesh) samples.push_back(shapes::samplesOf(*t.mesh, s.fitting.samples));
  }
  const shapes::HarmonicAnnulus annulus = annulusFor(s, targets, samples);
  shapes::requireUsable(annulus);

  const Fits fits = fitAll(context, s, targets, samples, annulus);
  auto step = context.step("combine");
  const std::vector<double> weights =
      s.weights.empty() ? std::vector<double>(fits.shapes.size(), 1.0) : s.weights;
  const shapes::HarmonicShape shape = shapes::combine(fits.shapes, weights);
  writeTextFile(context.output("coefficients.json"), provenance::textOf(jsonOf(shape), 1) + "\n");
  writeTextFile(context.output("fit.tsv"), fits.table);
  writeShape(context, "shape", shape, s.grid);
  if (annulus.dimension == 3) {
    io::writeVolume(context.output("field.nii.gz"), shapes::fieldOf(shape, s.grid));
  }
  shapes::EmbedSummary summary{.dimension = annulus.dimension,
                               .targets = targets.size(),
                               .coefficients = 2 * annulus.perBoundary(),
                               .innerRadius = annulus.innerRadius,
                               .outerRadius = annulus.outerRadius,
                               .order = annulus.order,
                               .width = shapes::widthOf(annulus),
                               .voxel = 2 * annulus.outerRadius / (s.grid - 1),
                               .boundaryMargin = shapes::boundaryMargin(shape),
                               .symmetricDifference = fits.symmetricDifference};
  summary.distanceMean = summary.distanceMax = std::nullopt;
  if (targets.size() == 1) measureDistance(shape, targets.front(), s.grid, summary);
  context.results(summary);
  return fits.termination;
}

}  // namespace

Command embedCommand() {
  return makeCommand<EmbedSettings>("embed", declare, run);
}

}  // namespace explica::app
