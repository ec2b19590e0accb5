// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/Orientation.h"
#include "Explica/Ventricle/WallThickness.h"

#include <string>
#include <vector>

namespace explica::ventricle {

inline constexpr int kSegments = 17;

/// One of the left ventricle's 17 segments [Cerqueira2002] in one frame.  Lengths in mm, NaN where
/// nothing counts.
struct Segment {
  int number = 0;           ///< 1 to 17
  std::size_t voxels = 0;   ///< that count
  std::size_t leftOut = 0;  ///< voxels of the wall that do not
  double thickness = kNaN;  ///< mean over columns; NaN if less than a tenth of the voxels counts
  double deviation = kNaN, lowest = kNaN, highest = kNaN;
  double plain = kNaN;       ///< as thickness, within the slice without correction
  double thickening = kNaN;  ///< percent of the end-diastolic thickness
};

/// "basal anterior"; without orientation "basal 1".
[[nodiscard]] std::string segmentName(int number, bool oriented);

/// Segment of a place: the third of the cavity's length that it is in, and the angle from the
/// anterior insertion: 60 degrees a segment, 90 in the apical third; 17 beyond the cavity's apex;
/// 0 above its base.
[[nodiscard]] int segmentAt(double share, double angleDeg);

/// The segments of a frame.
struct Segments {
  std::vector<Segment> rows;       ///< 17
  Volume<std::uint8_t> segmentOf;  ///< of every voxel of the wall, those left out included; else 0
};

/// Divides a frame's wall.  Around the cavity's centroid of each slice that is a whole ring, else
/// around the axis.
/// @param axis  direction of the end-diastolic axis, ends of this frame's cavity (withEndsOf)
[[nodiscard]] Segments segmentsOf(const Volume<Label>& heart, const WallThickness& wall,
                                  const LongAxis& axis, const Orientation& orientation);

}  // namespace explica::ventricle
