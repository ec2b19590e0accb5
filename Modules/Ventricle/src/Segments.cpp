// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Segments.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::ventricle {

namespace {

// Names of the 17 segments of the American Heart Association [Cerqueira2002], without the apex.
constexpr std::array<const char*, 3> kThird = {"basal", "mid", "apical"};
constexpr std::array<const char*, 6> kSix = {"anterior", "anteroseptal",  "inferoseptal",
                                             "inferior", "inferolateral", "anterolateral"};
constexpr std::array<const char*, 4> kFour = {"anterior", "septal", "inferior", "lateral"};

// Of a segment's voxels: fewer say nothing about the segment.
constexpr double kLeastShare = 0.1;

/// Middle of the cavity at the height of a voxel.
Point middleAt(const WallThickness& wall, const LongAxis& axis, const Grid& grid, const Point& x,
               int k) {
  const Slice& slice = wall.slices[static_cast<std::size_t>(k)];
  if (!wall.bySlice || !slice.whole()) return axis.foot(x);
  const Eigen::Vector2d index = slice.centre.cwiseQuotient(grid.spacing.head<2>());
  return grid.toWorld(Vector(index[0], index[1], k));
}

}  // namespace

std::string segmentName(int number, bool oriented) {
  if (number == kSegments) return "apex";
  const int third = (number - 1) / 6;
  const int place = (number - 1) % 6;
  const std::string level = kThird[third];
  if (!oriented) return level + ' ' + std::to_string(place + 1);
  return level + ' ' + (third < 2 ? kSix[place] : kFour[place]);
}

int segmentAt(double share, double angleDeg) {
  if (share < 0) return 0;
  if (share > 1) return kSegments;
  const int third = std::min(2, static_cast<int>(3 * share));
  if (third < 2) return 6 * third + 1 + (1 + static_cast<int>(angleDeg / 60)) % 6;
  // Apical segments are centred like the rings above: the septal one starts 15 degrees on.
  return 13 + (1 + static_cast<int>(std::fmod(angleDeg - 15 + 360, 360) / 90)) % 4;
}

Segments segmentsOf(const Volume<Label>& heart, const WallThickness& wall, const LongAxis& axis,
                    const Orientation& orientation) {
  Segments result;
  result.segmentOf = Volume<std::uint8_t>(heart.grid, 0);
  parallelFor(heart.size(), 1 << 14, [&](std::size_t v) {
    if (heart[v] != kWall) return;
    const auto s = heart.grid.subscripts(v);
    const Point x = centreOf(heart.grid, v);
    const double angle = orientation.angleDeg(axis, x, middleAt(wall, axis, heart.grid, x, s[2]));
    result.segmentOf[v] = static_cast<std::uint8_t>(segmentAt(axis.share(x), angle));
  });
  std::array<ColumnMean, kSegments + 1> means;
  std::array<std::size_t, kSegments + 1> all{};
  for (const std::uint8_t segment : result.segmentOf.data) ++all[segment];
  for (std::size_t n = 0; n < wall.thickness.size(); ++n) {
    if (!wall.counts(n)) continue;
    const std::uint8_t segment =
        result.segmentOf[wall.annulus.linear(static_cast<std::int32_t>(n))];
    means[segment].add(wall.thickness[n], wall.plain[n]);
  }
  for (int number = 1; number <= kSegments; ++number) {
    const ColumnMean& m = means[number];
    Segment row;
    row.number = number;
    row.voxels = m.count();
    row.leftOut = all[number] - m.count();
    if (static_cast<double>(m.count()) < kLeastShare * static_cast<double>(all[number])) {
      result.rows.push_back(row);
      continue;
    }
    row.thickness = m.mean();
    row.deviation = m.deviation();
    row.lowest = m.lowest();
    row.highest = m.highest();
    row.plain = m.plain();
    result.rows.push_back(row);
  }
  return result;
}

}  // namespace explica::ventricle
