// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace explica::repulsion {

inline constexpr int kGroupFaces = 16;

/// Three points on each of up to sixteen faces, and the field there: phi(x), the integral of
/// 1/|x - y|^2 over sources, and its gradient.  Point k of face i stands at 16 k + i.  Single
/// precision, about a centre nearby, so that a term is right to about 1e-6.
struct alignas(64) FieldPoints {
  static constexpr int kCount = 3 * kGroupFaces;
  float at[3][kCount];
  float phi[kCount];
  float gradient[3][kCount];
};

/// Faces that act as one, about the points' centre.
struct FieldCluster {
  float centre[3];  ///< centroid of the area
  float area;       ///< mm^2
  float second[6];  ///< moments of the area about the centroid, xx, yy, zz, xy, xz, yz, mm^4
};

/// A part of a face that acts by its centroid.
struct FieldPoint {
  float centre[3];
  float area;          ///< mm^2
  std::uint32_t acts;  ///< bit i: on the group's face i
};

/// Adds the sources' field, with the machine's widest vectors, chosen at run time; that of clusters
/// by the expansion about their centroids up to second moments M,
///   phi = A/r^2 - tr M/r^4 + 4 d'M d/r^6,  d from the centroid, r = |d|.
void addField(FieldPoints& points, std::span<const FieldCluster> clusters,
              std::span<const FieldPoint> sources);

/// Name of the instruction set in use.
[[nodiscard]] const char* fieldInstructionSet();

}  // namespace explica::repulsion
