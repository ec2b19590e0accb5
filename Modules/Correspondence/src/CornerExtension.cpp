// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "CornerExtension.h"

namespace explica::correspondence {

using harmonic::kInner;
using harmonic::kInsulated;

namespace {

// Nearer than this (in voxels) a wall's one-sided slope is round-off.
constexpr double kTooClose = 0.02;

}  // namespace

void CornerExtension::reachFrom(int seed) {
  std::array<int, 8> stack;
  int depth = 0;
  const auto reach = [&](int c) {
    state_[c] = kReached;
    u_[c] = interpolant_.u[number_[c]];
    g_[c] = gradientAt(number_[c]);
    stack[depth++] = c;
  };
  reach(seed);
  while (depth > 0) {
    const int c = stack[--depth];
    for (int a = 0; a < axes_; ++a) {
      const int other = c ^ (1 << a);
      if (state_[other] == kUnknown && number_[other] >= 0 &&
          annulus_.links[number_[c]][directionFrom(c, a)] == number_[other]) {
        reach(other);
      }
    }
  }
}

void CornerExtension::take(int corner, const Estimates& sum) {
  if (sum.count == 0) return;
  u_[corner] = sum.u / sum.count;
  g_[corner] = sum.slope / sum.count;
  extended_[extensions_++] = corner;
}

/// What one pass has extended counts from the next pass on.
void CornerExtension::settle() {
  while (extensions_ > 0) state_[extended_[--extensions_]] = kExtended;
}

/// The parabola through the voxel, the boundary on this link and what is behind.
void CornerExtension::addAlong(int from, int axis, Estimates& sum) const {
  const std::int32_t n = number_[from];
  const int d = directionFrom(from, axis);
  const int back = harmonic::opposite(d);
  const auto& links = annulus_.links[n];
  Vector slope = g_[from];
  ++sum.count;
  if (links[d] == kInsulated) {
    slope[axis] = -slope[axis];
    sum.u += u_[from];
    sum.slope += slope;
    return;
  }
  const auto& fractions = annulus_.fractions[annulus_.irregular(n)];
  const double sign = harmonic::signOf(d);
  const double wall = links[d] == kInner ? 0.0 : 1.0;
  const double theta = fractions[d], behind = fractions[back];
  const double outward = sign * g_[from][axis];
  double backSlope = 0;  // an insulated voxel behind mirrors this one
  if (links[back] >= 0) {
    backSlope = u_[from] - interpolant_.u[links[back]];
  } else if (links[back] != kInsulated) {
    backSlope = (u_[from] - (links[back] == kInner ? 0.0 : 1.0)) / behind;
  }
  const double second = theta < kTooClose
                            ? 2 * (outward - backSlope) / behind
                            : 2 * ((wall - u_[from]) / theta - backSlope) / (theta + behind);
  sum.u += u_[from] + outward + 0.5 * second;
  if (links[back] >= 0) slope += g_[from] - gradientAt(links[back]);
  slope[axis] = sign * (outward + second);
  sum.slope += slope;
}

void CornerExtension::extendAlongAxes() {
  for (int c = 0; c < corners_; ++c) {
    if (state_[c] == kReached) continue;
    Estimates sum;
    for (int a = 0; a < axes_; ++a) {
      if (state_[c ^ (1 << a)] == kReached) addAlong(c ^ (1 << a), a, sum);
    }
    take(c, sum);
  }
  settle();
}

/// Gradients add up as in a parallelogram.
void CornerExtension::addAcross(int corner, int a, int b, Estimates& sum) const {
  const int p = corner ^ (1 << a), q = corner ^ (1 << b), r = p ^ (1 << b);
  if (state_[p] == kUnknown || state_[q] == kUnknown || state_[r] == kUnknown) return;
  const Vector slope = g_[p] + g_[q] - g_[r];
  const double sideA = sideOf(corner, a), sideB = sideOf(corner, b);
  sum.u += 0.5 * (u_[p] + sideA * 0.5 * (g_[p][a] + slope[a]) + u_[q] +
                  sideB * 0.5 * (g_[q][b] + slope[b]));
  sum.slope += slope;
  ++sum.count;
}

/// Across the cell's faces, then across the cell.
void CornerExtension::extendAcrossFaces() {
  for (int pass = 0; pass < 2; ++pass) {
    for (int c = 0; c < corners_; ++c) {
      if (state_[c] != kUnknown) continue;
      Estimates sum;
      for (int a = 0; a < axes_; ++a) {
        for (int b = a + 1; b < axes_; ++b) addAcross(c, a, b, sum);
      }
      take(c, sum);
    }
    settle();
  }
}

void CornerExtension::extendLinearly() {
  for (int pass = 0; pass < 3; ++pass) {
    for (int c = 0; c < corners_; ++c) {
      for (int a = 0; a < axes_ && state_[c] == kUnknown; ++a) {
        const int p = c ^ (1 << a);
        if (state_[p] == kUnknown) continue;
        g_[c] = g_[p];
        u_[c] = u_[p] + sideOf(c, a) * g_[p][a];
        state_[c] = kExtended;
      }
    }
  }
}

std::uint8_t CornerExtension::write(Eigen::Array4f* corner) const {
  std::uint8_t reached = 0;
  for (int c = 0; c < corners_; ++c) {
    corner[c].head<3>() = g_[c].cast<float>().array();
    corner[c][3] = static_cast<float>(u_[c]);
    if (state_[c] == kReached) reached |= static_cast<std::uint8_t>(1U << c);
  }
  return reached;
}

}  // namespace explica::correspondence
