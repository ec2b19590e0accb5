// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"

#include <array>
#include <string_view>
#include <vector>

namespace explica::sampling {

/// What a depth between white and pial surface is a share of.
enum class DepthKind {
  Depth,  ///< of the distance from the white vertex to its pial vertex
  Volume  ///< of the volume of the column between them, which grows towards the wider end [Bok1929]
};
constexpr auto enumWords(DepthKind) {
  using enum DepthKind;
  return std::to_array<EnumWord<DepthKind>>({{Depth, "depth"}, {Volume, "volume"}});
}

/// Depths from 0, white, to 1, pial: "0.2,0.5,0.8", or a whole number N for N depths at equal
/// distances from 0 to 1 ("1" is the middle; the white surface is "0", the pial one "1.0").
/// @throws InvalidInput  no number, a depth outside [0, 1], one that is there twice, or more than
///                       1000
[[nodiscard]] std::vector<double> depthsFromText(std::string_view text);

/// Share of the way from white to pial, per vertex, below which `depth` of the column lies.
///
/// The column's cross-section grows linearly from the white vertex area a to the pial one b, so
/// that the share r of the way below which the share v of the volume lies solves
///     a r + (b - a) r^2 / 2 = v (a + b) / 2                                      [Waehnert2014]
/// @return V values in [0, 1]
[[nodiscard]] Eigen::VectorXd shareOfWay(const Eigen::VectorXd& whiteAreas,
                                         const Eigen::VectorXd& pialAreas, double depth,
                                         DepthKind kind);

/// Vertices at a depth between corresponding surfaces, V x 3, mm.
/// @throws InvalidInput  surfaces without the same number of vertices and faces
[[nodiscard]] Positions positionsAtDepth(const TriangleMesh& white, const TriangleMesh& pial,
                                         double depth, DepthKind kind);

/// The same at several depths, depth after depth: D V x 3.
[[nodiscard]] Positions positionsAtDepths(const TriangleMesh& white, const TriangleMesh& pial,
                                          const std::vector<double>& depths, DepthKind kind);

/// Demands that both surfaces have the same faces, so that vertex i of one belongs to vertex i of
/// the other.
/// @throws InvalidInput  says how they differ
void requireCorresponding(const TriangleMesh& white, const TriangleMesh& pial);

}  // namespace explica::sampling
