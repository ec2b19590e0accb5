// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Beat.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace explica::ventricle {

namespace {

constexpr double kMlPerMm3 = 1e-3;  // ml of a cubic millimetre

std::size_t countOf(const Volume<Label>& heart, Label label) {
  return static_cast<std::size_t>(std::count(heart.data.begin(), heart.data.end(), label));
}

double percentMore(double value, double reference) {
  return 100 * (value - reference) / reference;
}

Frame volumesOf(Volume<Label> heart, int number) {
  Frame frame;
  frame.number = number;
  frame.heart = std::move(heart);
  const double voxel = kMlPerMm3 * frame.heart.grid.voxelVolume();
  frame.cavity = voxel * static_cast<double>(countOf(frame.heart, kCavity));
  const std::size_t wall = countOf(frame.heart, kWall);
  if (wall == 0) {
    frame.why = "it has no wall";
    return frame;
  }
  frame.wall = voxel * static_cast<double>(wall);
  frame.mass = kMuscleDensity * frame.wall;
  return frame;
}

void measureFrame(Frame& frame, const Beat& beat, const HeartOptions& options,
                  const Monitor& monitor) {
  frame.axis = withEndsOf(frame.axis, frame.heart);
  if (std::isnan(frame.wall)) return;
  if (frame.cavity == 0) {
    frame.why = "it has no cavity";
    return;
  }
  try {
    frame.measures = measureWall(frame.heart, frame.axis, beat.alignment, options.wall, monitor);
  } catch (const InvalidInput& error) {
    frame.why = error.what();
    return;
  }
  ColumnMean mean;
  const WallThickness& wall = *frame.measures;
  for (std::size_t n = 0; n < wall.thickness.size(); ++n) {
    if (wall.counts(n)) mean.add(wall.thickness[n], wall.plain[n]);
  }
  frame.thickness = mean.mean();
  frame.plain = mean.plain();
  frame.segments = segmentsOf(frame.heart, wall, frame.axis, beat.orientation);
}

void checkGrids(const std::vector<Volume<Label>>& hearts) {
  for (const Volume<Label>& heart : hearts) {
    if (!sameGrid(heart.grid, hearts[0].grid)) {
      throw InvalidInput("the frames lie on different grids; frames of one beat share theirs");
    }
  }
  if (hearts[0].grid.dimension() == 2) {
    throw InvalidInput("segments of the heart need a stack of slices; this image has one");
  }
}

void compareWithDiastole(Beat& beat) {
  const Frame& reference = beat.frames[beat.diastole];
  for (Frame& frame : beat.frames) {
    frame.thickening = percentMore(frame.thickness, reference.thickness);
    if (!frame.segments) continue;
    for (std::size_t s = 0; s < frame.segments->rows.size(); ++s) {
      Segment& row = frame.segments->rows[s];
      row.thickening = percentMore(row.thickness, reference.segments->rows[s].thickness);
    }
  }
}

}  // namespace

Phases phasesOf(const std::vector<Volume<Label>>& hearts) {
  Phases phases;
  std::size_t greatest = 0, smallest = std::numeric_limits<std::size_t>::max();
  for (std::size_t f = 0; f < hearts.size(); ++f) {
    const std::size_t cavity = countOf(hearts[f], kCavity);
    if (cavity == 0) continue;  // a frame that nobody has labelled
    if (cavity > greatest) greatest = cavity, phases.diastole = f;
    if (cavity < smallest) smallest = cavity, phases.systole = f;
  }
  return phases;
}

Beat measureBeat(std::vector<Volume<Label>> hearts, const std::vector<int>& numbers,
                 const HeartOptions& options, const std::optional<Phases>& phases,
                 const Monitor& monitor) {
  if (hearts.empty() || numbers.size() != hearts.size()) {
    throw InvalidInput("every frame needs a number, and there must be one frame at least");
  }
  checkGrids(hearts);
  const Phases found = phases.value_or(phasesOf(hearts));
  Beat beat;
  beat.diastole = found.diastole;
  beat.systole = found.systole;
  LongAxis axis = findLongAxis(hearts[beat.diastole]);
  if (countOf(hearts[beat.diastole], kWall) == 0) {
    throw InvalidInput("end-diastole, frame " + std::to_string(numbers[beat.diastole]) +
                       ", has no wall; thickness needs one there (choose frames with --phases)");
  }
  // The axis of slices that jump says wrongly which of them the base cuts.
  for (int round = 0; round < 2; ++round) {
    beat.alignment = alignSlices(hearts, axis);
    if (hasThickSlices(hearts[0].grid)) {
      axis = findLongAxis(hearts[beat.diastole], beat.alignment.shift);
    }
  }
  beat.orientation = findOrientation(hearts[beat.diastole], axis, options.orientation);
  for (std::size_t f = 0; f < hearts.size(); ++f) {
    beat.frames.push_back(volumesOf(std::move(hearts[f]), numbers[f]));
    beat.frames.back().axis = axis;
  }
  for (std::size_t f = 0; f < beat.frames.size(); ++f) {
    monitor.progress(static_cast<double>(f) / static_cast<double>(beat.frames.size()), "wall");
    measureFrame(beat.frames[f], beat, options, monitor);
  }
  if (!beat.atDiastole().segments) {
    throw InvalidInput("end-diastole, frame " + std::to_string(beat.atDiastole().number) +
                       ", cannot be measured: " + beat.atDiastole().why);
  }
  compareWithDiastole(beat);
  if (beat.systole != beat.diastole) {
    beat.ejectionFraction = -percentMore(beat.atSystole().cavity, beat.atDiastole().cavity);
  }
  return beat;
}

std::vector<SliceRow> sliceRows(const Frame& frame) {
  std::vector<SliceRow> rows;
  const Grid& grid = frame.heart.grid;
  const double pixel = grid.spacing[0] * grid.spacing[1];
  const std::vector<Slice> slices = slicesOf(frame.heart);
  std::vector<ColumnMean> means(slices.size());
  std::vector<std::size_t> counted(slices.size(), 0);
  if (frame.measures) {
    const WallThickness& wall = *frame.measures;
    for (std::size_t n = 0; n < wall.thickness.size(); ++n) {
      const auto k = static_cast<std::size_t>(wall.annulus.index(static_cast<std::int32_t>(n))[2]);
      if (wall.counts(n)) means[k].add(wall.thickness[n], wall.plain[n]);
      counted[k] += wall.counts(n);
    }
  }
  for (std::size_t k = 0; k < slices.size(); ++k) {
    if (slices[k].kind == SliceKind::Empty) continue;
    SliceRow row{.slice = static_cast<int>(k),
                 .kind = slices[k].kind,
                 .cavityArea = pixel * static_cast<double>(slices[k].cavity),
                 .wallArea = pixel * static_cast<double>(slices[k].wall),
                 .openShare = slices[k].openShare};
    if (slices[k].cavity > 0 && slices[k].wall > 0) {
      row.areaEquivalent =
          std::sqrt((row.cavityArea + row.wallArea) / kPi) - std::sqrt(row.cavityArea / kPi);
    }
    row.plain = means[k].plain();
    row.thickness = means[k].mean();
    row.obliquityDeg = std::acos(std::min(1.0, row.thickness / row.plain)) * 180 / kPi;
    row.counted = counted[k];
    row.leftOut = slices[k].wall - counted[k];
    rows.push_back(row);
  }
  return rows;
}

}  // namespace explica::ventricle
