// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Hemispheres.h"

#include "Explica/Core/Errors.h"
#include "Explica/Surface/Measures.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace explica::surface {
namespace {

/// A plane near the middle and near sagittal: signed distance is n . x - offset, left negative.
struct Plane {
  Vector normal = Vector::UnitX();
  double offset = 0;
};

/// The near-sagittal plane through the middle of the mask that holds least of it.
/// @param unit  a millimetre in a human brain, mm
Plane leastWhitePlane(const std::vector<Point>& points, const Point& centre, double thickness,
                      double unit) {
  Plane best;
  double least = kInfinity;
  const auto search = [&](double yaw0, double roll0, double shift0, double angle, double shift,
                          int steps) {
    double bestYaw = yaw0, bestRoll = roll0, bestShift = shift0;
    for (int y = -steps; y <= steps; ++y) {
      for (int r = -steps; r <= steps; ++r) {
        const double yaw = yaw0 + y * angle, roll = roll0 + r * angle;
        const Vector normal = Vector(1, std::tan(yaw), std::tan(roll)).normalized();
        // One pass over the points serves all shifts.
        const int bins = 2 * steps + 1;
        std::vector<double> held(bins, 0);
        for (const Point& p : points) {
          const double d = normal.dot(p - centre) - shift0;
          const double nearest = std::round(d / shift);
          if (std::abs(nearest) <= steps && std::abs(d - nearest * shift) <= thickness) {
            held[static_cast<int>(nearest) + steps] += 1;
          }
        }
        for (int s = 0; s < bins; ++s) {
          const double at = shift0 + (s - steps) * shift;
          // A plane far from the middle is not it, however empty.
          const double cost =
              held[s] + 1e-5 * static_cast<double>(points.size()) * (at * at) / (unit * unit);
          if (cost < least) {
            least = cost;
            bestYaw = yaw;
            bestRoll = roll;
            bestShift = at;
            best.normal = normal;
            best.offset = normal.dot(centre) + at;
          }
        }
      }
    }
    return std::array{bestYaw, bestRoll, bestShift};
  };
  const auto coarse = search(0, 0, 0, 0.05, 2.0 * unit, 5);
  least = kInfinity;
  search(coarse[0], coarse[1], coarse[2], 0.015, 2.0 / 3 * unit, 3);
  return best;
}

}  // namespace

Volume<std::uint8_t> splitHemispheres(const Volume<std::uint8_t>& white, const Monitor& monitor) {
  const Grid& grid = white.grid;
  std::vector<Point> points;
  Point centre = Point::Zero();
  for (std::size_t v = 0; v < white.size(); ++v) {
    if (!white[v]) continue;
    points.push_back(centreOf(grid, v));
    centre += points.back();
  }
  if (points.empty()) throw InvalidInput("hemisphere: no white matter to separate");
  centre /= static_cast<double>(points.size());
  std::vector<Point> some;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / 60000);
  for (std::size_t p = 0; p < points.size(); p += stride) some.push_back(points[p]);
  // Lengths are those of a human brain, whose white matter has the volume of a ball of 48 mm.
  constexpr double kHuman = 48;
  const double unit = radiusOfVoxels(static_cast<std::int64_t>(points.size()), grid) / kHuman;
  const Plane plane = leastWhitePlane(some, centre, 0.5 * grid.spacing.maxCoeff(), unit);

  Volume<std::uint8_t> sides(grid);
  const double sure = 10 * unit;  // from the plane: no gyrus bulges that far
  for (std::size_t v = 0; v < white.size(); ++v) {
    if (!white[v]) continue;
    const double d = plane.normal.dot(centreOf(grid, v)) - plane.offset;
    if (std::abs(d) > sure) sides[v] = d < 0 ? 1 : 2;
  }
  spreadLabels(white, sides);
  const auto left = std::count(sides.data.begin(), sides.data.end(), 1);
  const auto right = std::count(sides.data.begin(), sides.data.end(), 2);
  if (10 * std::min(left, right) < left + right) {
    throw InvalidInput("hemisphere: white matter does not hold two hemispheres (" +
                       std::to_string(left) + " voxels left, " + std::to_string(right) +
                       " right of the plane with least white matter)");
  }
  monitor.progress(1.0, "hemispheres separated");
  return sides;
}

void warnOfTwoHemispheres(const Mask& white, const Monitor& monitor) {
  constexpr double kBrain = 150000;  // mm^3 of white matter: more than one hemisphere's least
  if (static_cast<double>(voxelsIn(white)) * white.grid.voxelVolume() < kBrain) return;
  std::int64_t left = 0, right = 0;
  try {
    const Mask sides = splitHemispheres(white);
    left = std::count(sides.data.begin(), sides.data.end(), 1);
    right = std::count(sides.data.begin(), sides.data.end(), 2);
  } catch (const InvalidInput&) {
    return;  // not two hemispheres: nothing to say
  }
  if (std::min(left, right) * 3 < std::max(left, right) * 2) return;
  monitor.warn("white matter may hold two hemispheres (" + std::to_string(left) + " voxels left, " +
               std::to_string(right) +
               " right of the plane with least white matter); --hemisphere L or R takes one");
}

std::int64_t contactOf(const Mask& sides) {
  std::int64_t contact = 0;
  const auto& n = sides.grid.size;
  for (int k = 0; k + 1 < n[2]; ++k) {
    for (int j = 0; j + 1 < n[1]; ++j) {
      for (int i = 0; i + 1 < n[0]; ++i) {
        for (const auto other : {sides(i + 1, j, k), sides(i, j + 1, k), sides(i, j, k + 1)}) {
          contact += sides(i, j, k) + other == 3 && sides(i, j, k) && other;
        }
      }
    }
  }
  return contact;
}

std::int64_t takeHemisphere(Side side, TissueMasks& masks, const Monitor& monitor) {
  Mask& white = masks.white;
  const Mask sides = splitHemispheres(white, monitor);
  Mask all = sides;
  spreadLabels(
      setWhere(white.grid, [&](std::size_t v) { return white[v] != 0 || masks.grey[v] != 0; }),
      all);
  const std::uint8_t own = side == Side::Left ? 1 : 2;
  for (std::size_t v = 0; v < white.size(); ++v) {
    if (white[v] && sides[v] != own) {
      white[v] = 0;
      masks.insulated[v] = 1;
    }
    if (masks.grey[v] && all[v] != own) masks.grey[v] = 0;
  }
  return contactOf(sides);
}

}  // namespace explica::surface
