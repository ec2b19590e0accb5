// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonPhantoms.h"

#include <initializer_list>

namespace explica::planar {
namespace {

/// The region's vertices, then those of the block below it.
PolygonPhantom blockUnder(std::initializer_list<Point2> folds) {
  PolygonPhantom phantom;
  Positions2 region(static_cast<Eigen::Index>(folds.size()), 2);
  Eigen::Index row = 0;
  for (const Point2& p : folds) region.row(row++) = p.transpose();
  const Point2 low = region.colwise().minCoeff().transpose();
  const Point2 high = region.colwise().maxCoeff().transpose();
  constexpr double kSide = 28;   // of the block beyond the folds, pixels
  constexpr double kDepth = 60;  // of the block below them
  constexpr double kFar = 4000;  // "much farther away than presented", thesis section 4.2.4
  phantom.curve.positions.resize(region.rows() + 4, 2);
  phantom.curve.positions << region,            //
      low.x() - kSide, low.y() - 0.2 * kDepth,  //
      low.x() - kSide, low.y() - kDepth,        //
      high.x() + kSide, low.y() - kDepth,       //
      high.x() + kSide, low.y() - 0.2 * kDepth;
  phantom.first = 0;
  phantom.last = static_cast<int>(region.rows()) - 1;
  phantom.viewpoint = {(low.x() + high.x()) / 2, kFar};
  return phantom;
}

}  // namespace

PolygonPhantom makePolygon19() {
  return blockUnder({{99.1, 55.3}, {92.3, 76.2},  {102.6, 95.8}, {88.5, 112.6}, {66.8, 110.2},
                     {61.1, 89.2}, {79.7, 77.7},  {77.3, 56},    {57.2, 47.7},  {39.3, 60.1},
                     {51.7, 78.3}, {48.8, 100.1}, {30.2, 111.5}, {10.1, 103.1}, {16.5, 82.1},
                     {32.7, 67.4}, {34.1, 45.6},  {13.5, 38},    {-1.6, 22.1},  {10.6, 3.9}});
}

PolygonPhantom makePolygon34() {
  return blockUnder({{145.6, 17.1}, {140, -2.8},   {124.5, 12},   {104.7, 4.4},  {93.3, 22},
                     {112.9, 29.1}, {133.2, 24.9}, {154.2, 21.9}, {161.2, 41.9}, {140.4, 43.9},
                     {119.5, 38.8}, {98.4, 42.1},  {78.8, 33.6},  {70.3, 52.6},  {90.5, 57.2},
                     {111.3, 51.6}, {132.4, 54.3}, {153.1, 48.7}, {160.8, 68.5}, {139.8, 73.3},
                     {118.3, 68.8}, {96.5, 71.7},  {73.7, 70.1},  {51.6, 72.8},  {29.6, 70.7},
                     {13.3, 56.4},  {33.4, 52.4},  {50, 40},      {31.9, 28.8},  {14.2, 40.2},
                     {0.6, 24.3},   {20.5, 19.9},  {37.4, 7.6},   {25.7, -10.5}, {21.2, 10.3}});
}

}  // namespace explica::planar
