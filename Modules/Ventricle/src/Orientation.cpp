// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Orientation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::ventricle {

namespace {

constexpr double kFarMm = 20;   // from the wall: a right ventricle's insertion lies on it
constexpr double kTouchMm = 5;  // between labels of wall and right ventricle: its own thin wall
constexpr int kBins = 120;      // around the axis, 3 degrees each
constexpr int kGapBins = 10;    // of the septum that may lack

std::string text(const Point& p) {
  return printed("%.1f,%.1f,%.1f", p[0], p[1], p[2]);
}

/// Unit vector across the axis; nothing if the vector runs along it.
std::optional<Vector> across(const LongAxis& axis, Vector v) {
  v -= v.dot(axis.direction) * axis.direction;
  if (v.norm() < 1e-6) return {};
  return v.normalized();
}

std::vector<Point> pointsOf(const Volume<Label>& heart, Label label) {
  std::vector<Point> points;
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (heart[v] == label) points.push_back(centreOf(heart.grid, v));
  }
  return points;
}

/// Wall voxels of the two basal thirds with the right ventricle within reach in their slice.
std::vector<Point> septalPoints(const Volume<Label>& heart, const LongAxis& axis) {
  std::vector<Point> points;
  const auto& size = heart.grid.size;
  const int ri = static_cast<int>(kTouchMm / heart.grid.spacing[0]);
  const int rj = static_cast<int>(kTouchMm / heart.grid.spacing[1]);
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (heart[v] != kWall) continue;
    const auto s = heart.grid.subscripts(v);
    const Point x = centreOf(heart.grid, v);
    const double share = axis.share(x);
    if (share < 0 || share > 2.0 / 3) continue;
    bool touches = false;
    for (int j = std::max(0, s[1] - rj); j <= std::min(size[1] - 1, s[1] + rj) && !touches; ++j) {
      for (int i = std::max(0, s[0] - ri); i <= std::min(size[0] - 1, s[0] + ri); ++i) {
        if (heart(i, j, s[2]) != kRight) continue;
        touches = std::hypot((i - s[0]) * heart.grid.spacing[0],
                             (j - s[1]) * heart.grid.spacing[1]) <= kTouchMm;
        if (touches) break;
      }
    }
    if (touches) points.push_back(x);
  }
  return points;
}

/// An arc of bins around the axis.
struct Arc {
  int first = 0, length = 0;
};

/// The arc that holds all taken bins but for gaps, the longest if there are several.
Arc longestArc(std::array<bool, kBins> taken) {
  std::array<bool, kBins> filled = taken;
  for (int b = 0; b < kBins; ++b) {
    if (!taken[b]) continue;
    for (int ahead = 2; ahead <= kGapBins; ++ahead) {
      if (!taken[(b + ahead) % kBins]) continue;
      for (int q = 1; q < ahead; ++q) filled[(b + q) % kBins] = true;
    }
  }
  Arc best;
  for (int b = 0; b < kBins; ++b) {
    if (!filled[b] || filled[(b + kBins - 1) % kBins]) continue;
    int length = 0;
    while (length < kBins && filled[(b + length) % kBins]) ++length;
    if (length > best.length) best = {b, length};
  }
  return best;
}

/// From the label of the right ventricle; nothing if it touches the wall nowhere.
std::optional<Orientation> fromRightVentricle(const Volume<Label>& heart, const LongAxis& axis) {
  const std::vector<Point> septum = septalPoints(heart, axis);
  if (septum.empty()) return {};
  Orientation found;
  found.anterior = across(axis, heart.grid.direction.col(0))
                       .value_or(heart.grid.direction.col(1));  // any, turned with the image
  std::array<int, kBins> count{};
  for (const Point& x : septum) {
    const double angle = found.angleDeg(axis, x, axis.foot(x));
    ++count[static_cast<std::size_t>(angle / 360 * kBins) % kBins];
  }
  // Bins with few voxels are those of single slices.
  const double usual = static_cast<double>(septum.size()) / kBins;
  std::array<bool, kBins> taken{};
  for (int b = 0; b < kBins; ++b) taken[b] = count[b] > 0.5 * usual;
  const Arc arc = longestArc(taken);
  if (arc.length == 0) return {};
  found.source = OrientationSource::RightVentricle;
  found.septumDeg = 360.0 * arc.length / kBins;
  const double middle = (arc.first + 0.5 * arc.length) * 2 * kPi / kBins;
  // The septum's two segments take 120 degrees, of which the first begins at the anterior
  // insertion.
  found.anterior = Eigen::AngleAxisd(middle - kPi / 3, axis.direction) * found.anterior;
  return found;
}

Orientation fromPoint(const Volume<Label>& heart, const LongAxis& axis, const Point& insertion) {
  double nearest = kInfinity;
  for (const Point& x : pointsOf(heart, kWall)) nearest = std::min(nearest, (x - insertion).norm());
  const auto direction = across(axis, insertion - axis.centre);
  const double offAxis = (insertion - axis.foot(insertion)).norm();
  if (nearest > kFarMm || !direction || offAxis < 2) {
    throw InvalidInput(
        "--rv-insertion " + text(insertion) + " lies " +
        printed("%.0f mm", nearest > kFarMm ? nearest : offAxis) +
        (nearest > kFarMm ? " from the wall" : " from the long axis") +
        "; the middle of the cavity is at " + text(axis.centre) +
        ". To find the point, open the image in a viewer (ITK-SNAP, FSLeyes, 3D Slicer), go to a "
        "short-axis slice half way down the ventricle, put the cursor where the front end of the "
        "right ventricle's wall meets the left one, and read the RAS (scanner) coordinates in mm; "
        "or give --rv-insertion-image-axis");
  }
  Orientation found;
  found.source = OrientationSource::Point;
  found.anterior = *direction;
  return found;
}

Vector directionOf(const Grid& grid, ImageAxis axis) {
  const int column = axis == ImageAxis::IPlus || axis == ImageAxis::IMinus ? 0 : 1;
  const double sign = axis == ImageAxis::IPlus || axis == ImageAxis::JPlus ? 1 : -1;
  return sign * grid.direction.col(column);
}

/// The image direction that points most to the front of the patient.
Vector mostAnterior(const Grid& grid) {
  Vector best = grid.direction.col(0);
  for (const auto& [axis, name] : enumWords(ImageAxis{})) {
    const Vector v = directionOf(grid, axis);
    if (v[1] > best[1]) best = v;
  }
  return best;
}

}  // namespace

double Orientation::angleDeg(const LongAxis& axis, const Point& x, const Point& middle) const {
  const Vector here = x - middle;
  const double angle = std::atan2(axis.direction.dot(anterior.cross(here)), anterior.dot(here));
  const double degrees = angle * 180 / kPi;
  return degrees < 0 ? std::min(degrees + 360, std::nextafter(360.0, 0.0)) : degrees;
}

Orientation findOrientation(const Volume<Label>& heart, const LongAxis& axis,
                            const OrientationOptions& options) {
  if (options.insertion) return fromPoint(heart, axis, *options.insertion);
  Orientation found;
  if (options.imageAxis) {
    const auto direction = across(axis, directionOf(heart.grid, *options.imageAxis));
    if (!direction) {
      throw InvalidInput("--rv-insertion-image-axis " + std::string(nameOf(*options.imageAxis)) +
                         " runs along the ventricle's long axis");
    }
    found.source = OrientationSource::ImageAxis;
    found.anterior = *direction;
    return found;
  }
  if (auto fromLabel = fromRightVentricle(heart, axis)) return *fromLabel;
  found.anterior = across(axis, mostAnterior(heart.grid)).value_or(heart.grid.direction.col(2));
  return found;
}

}  // namespace explica::ventricle
