// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/Segments.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::ventricle {

/// Density of muscle, g/ml.
inline constexpr double kMuscleDensity = 1.05;

struct HeartOptions {
  WallOptions wall;
  OrientationOptions orientation;
};

/// A slice's row of numbers.  Lengths in mm, areas in mm^2.
struct SliceRow {
  int slice = 0;
  SliceKind kind = SliceKind::Empty;
  double cavityArea = 0, wallArea = 0;
  double openShare = 0;                  ///< of the cavity's outline
  double areaEquivalent = kNaN;          ///< wall of concentric circles of the same areas
  double plain = kNaN;                   ///< mean over columns that count, within the slice
  double thickness = kNaN;               ///< the same, corrected for obliquity
  double obliquityDeg = kNaN;            ///< angle whose cosine is thickness / plain
  std::size_t counted = 0, leftOut = 0;  ///< voxels of the wall
};

/// One frame.  Volumes in ml, masses in g, lengths in mm.
struct Frame {
  int number = 0;  ///< as the user counts, from 0
  Volume<Label> heart;
  double cavity = 0, wall = kNaN, mass = kNaN;
  double thickness = kNaN, plain = kNaN;  ///< means over columns of the counted wall
  double thickening = kNaN;               ///< percent of end-diastole's
  std::optional<WallThickness> measures;  ///< unset: no wall, `why` tells
  std::optional<Segments> segments;
  LongAxis axis;  ///< end-diastole's, with this frame's ends
  std::string why;
};

/// A heart over time.
struct Beat {
  std::vector<Frame> frames;
  std::size_t diastole = 0, systole = 0;  ///< places in `frames`
  Orientation orientation;
  SliceAlignment alignment;                ///< of all frames together
  std::optional<double> ejectionFraction;  ///< percent; with two frames or more

  [[nodiscard]] const Frame& atDiastole() const { return frames[diastole]; }
  [[nodiscard]] const Frame& atSystole() const { return frames[systole]; }
  [[nodiscard]] bool oriented() const { return orientation.source != OrientationSource::None; }
};

/// Which frames are end-diastole and end-systole.
struct Phases {
  std::size_t diastole = 0, systole = 0;
};

/// Those of greatest and of smallest cavity.  Papillary muscles belong to whatever their label is.
[[nodiscard]] Phases phasesOf(const std::vector<Volume<Label>>& hearts);

/// Measures all frames.  Axis and orientation are end-diastole's; the thirds follow each frame's
/// own cavity along that axis.
/// @param hearts   with this module's labels, one grid
/// @param numbers  as many, how the user counts them
/// @param phases   places in `hearts`; unset: phasesOf
/// @throws InvalidInput  grids that differ, no cavity, no wall at end-diastole
[[nodiscard]] Beat measureBeat(std::vector<Volume<Label>> hearts, const std::vector<int>& numbers,
                               const HeartOptions& options = {},
                               const std::optional<Phases>& phases = {},
                               const Monitor& monitor = {});

/// A frame's slices that hold cavity or wall.
[[nodiscard]] std::vector<SliceRow> sliceRows(const Frame& frame);

/// Tab-separated values with a header; lengths and volumes with three digits, n/a where unknown.
[[nodiscard]] std::string frameTable(const Beat& beat);
[[nodiscard]] std::string segmentTable(const Beat& beat);
[[nodiscard]] std::string sliceTable(const Beat& beat);

}  // namespace explica::ventricle
