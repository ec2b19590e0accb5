// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Correspondence.h"

#include <string>
#include <vector>

namespace explica::correspondence {

/// Wall thickness of one of the left ventricle's 17 segments [Cerqueira2002].
struct WallSegment {
  int segment = 0;  ///< 1 to 17
  std::string name;
  std::size_t voxels = 0;
  double mean = kNaN, deviation = kNaN, minimum = kNaN, maximum = kNaN;  ///< mm; NaN if no voxel
};

struct WallSegments {
  std::vector<WallSegment> rows;  ///< 17
  std::vector<int> segmentOf;     ///< per tissue voxel; 0 where the thickness is unknown
  bool apexAtHighSlice = true;    ///< as judged by the cavity, which is wider at the base
};

/// Divides a stack of short-axis slices (along k): the slices with cavity into basal, middle and
/// apical thirds, those beyond the cavity to the apex (17).  Around the cavity's centre of each
/// slice angles run from the anterior insertion of the right ventricle towards the septum, which is
/// counter-clockwise seen from the apex: 60 degrees a segment, 90 in the apical third.
/// @param insertion  RAS mm, where the right ventricle's anterior wall joins the left one
/// @throws InvalidInput  a planar image, or no slice with both tissue and cavity
[[nodiscard]] WallSegments wallSegments(const harmonic::Annulus& annulus,
                                        const Correspondence& correspondence,
                                        const Point& insertion);

/// The rows as tab-separated values with a header.
[[nodiscard]] std::string tableOf(const WallSegments& segments);

/// The rows as a bull's-eye picture: basal ring outside, apex in the middle, anterior on top.
[[nodiscard]] std::string bullseyeOf(const WallSegments& segments);

}  // namespace explica::correspondence
