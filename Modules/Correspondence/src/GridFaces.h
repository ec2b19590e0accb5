// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Annulus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace explica::correspondence {

/// A face of the grid between voxel centres, with a place in it.
struct Face {
  int b, c;                 ///< its axes, ascending, so that pairs lie in memory's order
  std::array<int, 3> base;  ///< first corner
  std::int32_t place[4];    ///< of its corners, two if planar
  float fb, fc;             ///< the place, from the first corner
};

/// The faces between the voxel centres of an annulus' box.
class GridFaces {
 public:
  explicit GridFaces(const harmonic::Annulus& annulus) : annulus_(annulus) {}

  /// The face that contains x; nothing beyond the image, which a trajectory may leave.
  [[nodiscard]] std::optional<Face> at(int axis, const Vector& x) const {
    Face face;
    const int b = face.b = axis == 0 ? 1 : 0, c = face.c = axis == 2 ? 1 : 2;
    face.base[axis] = static_cast<int>(x[axis]);
    face.base[b] = static_cast<int>(x[b]);
    face.base[c] = annulus_.planar ? static_cast<int>(std::lround(x[2])) : static_cast<int>(x[c]);
    if (!inBox(face.base, axis)) return {};
    face.fb = static_cast<float>(x[b] - face.base[b]);
    face.fc = annulus_.planar ? 0.0F : static_cast<float>(x[c] - face.base[c]);
    const auto strides = annulus_.strides();
    const std::int32_t p = face.base[0] + face.base[1] * strides[1] + face.base[2] * strides[2];
    for (int e = 0; e < corners(); ++e) {
      face.place[e] = p + (e & 1) * strides[b] + (e >> 1) * strides[c];
    }
    return face;
  }
  [[nodiscard]] int corners() const { return annulus_.planar ? 2 : 4; }

  /// Calls at(axis, x, length) for the grid planes that a walk crossed by its last step, of a voxel
  /// at most, in the order in which they are met, until it returns true: whether it did.
  template <class Walk, class At>
  bool between(const Walk& before, const Walk& after, const At& at) const {
    const Vector &from = before.x, step = after.x - from;
    const double length = after.length - before.length;
    // The step's cubic, which leaves and arrives with the walk's velocities.
    const Vector bend = length * (before.velocity + after.velocity) - 2 * step;
    const Vector start = length * before.velocity;
    const auto along = [&](double t) {
      return Vector(t * (start + t * (step - start - bend + t * bend)));
    };
    constexpr int kRounds = 2;  // of Newton's method, from where the chord crosses
    struct Pierced {
      double t;
      int axis;
      int plane;
    };
    Pierced pierced[3];
    int count = 0;
    for (int a = 0; a < (annulus_.planar ? 2 : 3); ++a) {
      if (std::abs(step[a]) < 1e-12) continue;
      // The next plane strictly ahead.
      const int below = static_cast<int>(from[a]);
      const int ahead = step[a] > 0 ? below + 1 : below - (from[a] == below ? 1 : 0);
      double t = (ahead - from[a]) / step[a];
      if (t > 1) continue;
      for (int k = 0; k < kRounds; ++k) {
        const double slope = start[a] + t * (2 * (step - start - bend)[a] + t * 3 * bend[a]);
        if (slope == 0) break;
        t = std::clamp(t - (from[a] + along(t)[a] - ahead) / slope, 0.0, 1.0);
      }
      int n = count++;
      for (; n > 0 && pierced[n - 1].t > t; --n) pierced[n] = pierced[n - 1];
      pierced[n] = {t, a, ahead};
    }
    for (int k = 0; k < count; ++k) {
      const double t = pierced[k].t;
      Vector x = from + along(t);
      x[pierced[k].axis] = pierced[k].plane;
      if (at(pierced[k].axis, x, before.length + t * length)) return true;
    }
    return false;
  }

 private:
  /// Whether the grid face at a voxel lies in the box: a trajectory that leaves the image may meet
  /// faces beyond it.
  [[nodiscard]] bool inBox(const std::array<int, 3>& base, int axis) const {
    for (int a = 0; a < 3; ++a) {
      const int reach = a == axis || (annulus_.planar && a == 2) ? 0 : 1;
      if (base[a] < 0 || base[a] + reach >= annulus_.size[a]) return false;
    }
    return true;
  }

  const harmonic::Annulus& annulus_;
};

}  // namespace explica::correspondence
