// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Interpolant.h"

#include <array>
#include <cstdint>

namespace explica::correspondence {

/// Corners of a cell while they are extended from the ones that one side of it has: u, and its
/// gradient per voxel.
class CornerExtension {
 public:
  CornerExtension(const harmonic::Annulus& annulus, const harmonic::Interpolant& interpolant,
                  const std::int32_t* number, bool flat)
      : annulus_(annulus),
        interpolant_(interpolant),
        number_(number),
        axes_(flat ? 2 : 3),
        corners_(flat ? 4 : 8) {}

  void reachFrom(int seed);
  void extendAlongAxes();
  void extendAcrossFaces();
  void extendLinearly();
  /// u and gradient of each corner; the corners that the seed reaches, one bit each.
  std::uint8_t write(Eigen::Array4f* corner) const;

 private:
  enum State : std::uint8_t { kUnknown, kReached, kExtended };
  /// Estimates of one corner, added up.
  struct Estimates {
    double u = 0;
    Vector slope = Vector::Zero();
    int count = 0;
  };

  /// +1 if the corner lies at the upper end of the axis, else -1.
  static int sideOf(int corner, int axis) { return (corner >> axis & 1) != 0 ? 1 : -1; }
  /// The direction along an axis that leads from a corner to the one opposite.
  static int directionFrom(int corner, int axis) {
    return 2 * axis + (sideOf(corner, axis) > 0 ? 0 : 1);
  }
  [[nodiscard]] Vector gradientAt(std::int32_t voxel) const {
    return interpolant_.gradient[voxel].cast<double>().cwiseProduct(annulus_.grid.spacing);
  }
  void addAlong(int from, int axis, Estimates& sum) const;
  void addAcross(int corner, int a, int b, Estimates& sum) const;
  void take(int corner, const Estimates& sum);
  void settle();

  const harmonic::Annulus& annulus_;
  const harmonic::Interpolant& interpolant_;
  const std::int32_t* number_;
  int axes_, corners_;
  std::array<State, 8> state_{};
  std::array<double, 8> u_;
  std::array<Vector, 8> g_;
  std::array<int, 8> extended_;
  int extensions_ = 0;
};

}  // namespace explica::correspondence
