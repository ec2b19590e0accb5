// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Phantom/BeatingVentricle.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::phantom {

namespace {

constexpr double kFocal = 40, kInnerSinh = 0.6, kOuterSinh = 0.9, kBase = 15;  // mm
constexpr double kRightReach = 25;      // mm, of the right ventricle beyond the wall
constexpr double kRightHalf = kPi / 3;  // half of the angle over which it touches the wall

double longHalf(double sinh) {
  return kFocal * std::sqrt(1 + sinh * sinh);
}

/// Volume of a spheroid below the base.
double volumeBelowBase(double sinh) {
  const double b = kFocal * sinh, a = longHalf(sinh);
  return kPi * b * b * (kBase + a - (kBase * kBase * kBase + a * a * a) / (3 * a * a));
}

/// The spheroid that holds a volume below the base.
double sinhOf(double volume) {
  double low = 0.01, high = 3;
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (volumeBelowBase(middle) < volume ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Mean thickness over columns, n / sum(1 / t), of points spread evenly over a third of the length.
std::array<double, 3> columnMeans(const harmonic::ExactAnnulus& exact, double inner, double outer) {
  constexpr int kAlong = 90, kAcross = 120;
  std::array<double, 3> volume = {}, columns = {};
  const double apex = -longHalf(inner), reach = kFocal * outer;
  for (int p = 0; p < kAlong; ++p) {
    const double z = kBase + (apex - kBase) * (p + 0.5) / kAlong;
    for (int q = 0; q < kAcross; ++q) {
      const double r = reach * (q + 0.5) / kAcross;
      const Point x(r, 0, z);
      if (exact.innerLevel(x) <= 0 || exact.outerLevel(x) >= 0) continue;
      volume[3 * p / kAlong] += r;
      columns[3 * p / kAlong] += r / exact.answer(x).thickness();
    }
  }
  return {volume[0] / columns[0], volume[1] / columns[1], volume[2] / columns[2]};
}

void check(const harmonic::PhantomOptions& size, const BeatOptions& o) {
  if (o.frames && (*o.frames < 1 || *o.frames > 200)) {
    throw InvalidInput("frames: " + std::to_string(*o.frames) + "; 1 to 200 are possible");
  }
  if (!(o.tiltDeg >= 0 && o.tiltDeg <= 40)) {
    throw InvalidInput("tilt: 0 to 40 degrees are possible, found " + std::to_string(o.tiltDeg));
  }
  if (!(o.ejectionFraction >= 0 && o.ejectionFraction <= 0.8)) {
    throw InvalidInput("ejection: 0 to 0.8 is possible, found " +
                       std::to_string(o.ejectionFraction));
  }
  if (!(size.spacing > 0) || (o.slice && !(*o.slice > 0 && *o.slice <= 20))) {
    throw InvalidInput("spacing and slice: positive lengths are needed, slices up to 20 mm");
  }
  const double reach = kFocal * kOuterSinh + kRightReach;
  if (size.size > 1024 || !(size.size * size.spacing > 2 * (reach + size.spacing))) {
    throw InvalidInput(
        "this phantom reaches " + std::to_string(reach) +
        " mm from the centre; size times spacing must exceed twice that, with at most 1024 voxels");
  }
}

/// Slices of which one ends at the base where the axis meets it, over all of the heart.
Grid gridOf(const harmonic::PhantomOptions& size, const BeatOptions& o) {
  const double slice = o.slice.value_or(size.spacing), tilt = o.tiltDeg * kPi / 180;
  const int below = static_cast<int>(std::ceil((kBase + longHalf(kOuterSinh)) / slice)) + 1;
  const int above = static_cast<int>(std::ceil(kFocal * kOuterSinh * std::sin(tilt) / slice)) + 1;
  Grid grid = harmonic::centredGrid({size.size, size.size, below + above},
                                    {size.spacing, size.spacing, slice});
  grid.origin[2] = kBase * std::cos(tilt) - (below - 0.5) * slice;
  return grid;
}

Label labelAt(const Point& x, const harmonic::ExactAnnulus& exact, double outerSinh) {
  if (x[2] > kBase) return 0;
  if (exact.innerLevel(x) <= 0) return 1;
  if (exact.outerLevel(x) < 0) return 2;
  const double fromSeptum = kPi - std::abs(std::atan2(x[1], x[0]));
  const double a = longHalf(outerSinh);
  if (fromSeptum > kRightHalf || x[2] < -0.6 * a) return 0;
  const double wall = kFocal * outerSinh * std::sqrt(1 - x[2] * x[2] / (a * a));
  const double reach = kRightReach * std::cos(0.5 * kPi * fromSeptum / kRightHalf);
  return std::hypot(x[0], x[1]) < wall + reach ? 3 : 0;
}

}  // namespace

BeatingVentricle beatingVentricle(const harmonic::PhantomOptions& size,
                                  const BeatOptions& options) {
  check(size, options);
  BeatingVentricle beat;
  beat.base = kBase;
  // Tilted about an axis that is neither the image's nor the right ventricle's.
  beat.toWorld =
      Eigen::AngleAxisd(options.tiltDeg * kPi / 180, Vector(1, 2, 0).normalized()).matrix();
  const Grid grid = gridOf(size, options);
  const double diastolic = volumeBelowBase(kInnerSinh);
  const double wall = volumeBelowBase(kOuterSinh) - diastolic;
  const int count = options.frames.value_or(1);
  for (int f = 0; f < count; ++f) {
    const double phase = 0.5 * (1 - std::cos(2 * kPi * f / count));
    BeatingVentricle::Frame frame;
    frame.cavity = diastolic * (1 - options.ejectionFraction * phase);
    frame.wall = wall;
    const double inner = sinhOf(frame.cavity), outer = sinhOf(frame.cavity + wall);
    frame.exact = harmonic::exactVentricle(kFocal, inner, outer, kBase);
    frame.thickness = columnMeans(frame.exact, inner, outer);
    frame.labels = Volume<Label>(grid, 0);
    parallelFor(grid.voxelCount(), 1 << 14, [&](std::size_t v) {
      const auto s = grid.subscripts(v);
      const Point x = beat.toHeart(grid.toWorld(Vector(s[0], s[1], s[2])));
      frame.labels[v] = labelAt(x, frame.exact, outer);
    });
    beat.frames.push_back(std::move(frame));
  }
  const double equator = kFocal * kOuterSinh;
  // Seen from the apex, which lies down, angles that grow from the anterior insertion to the septum
  // run clockwise about +z: the anterior insertion has the greater angle.
  const double angle = kPi + kRightHalf;
  beat.anteriorInsertion =
      beat.toWorld * Point(equator * std::cos(angle), equator * std::sin(angle), 0);
  return beat;
}

}  // namespace explica::phantom
