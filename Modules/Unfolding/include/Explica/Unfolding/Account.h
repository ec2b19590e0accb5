// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Unfolding/Unfolder.h"

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace explica::unfolding {

/// Mean at each vertex of the values of its listed faces, by area; `elsewhere` at other vertices.
[[nodiscard]] Eigen::VectorXd vertexMeans(const TriangleMesh& mesh,
                                          std::span<const std::int32_t> faces,
                                          const Eigen::VectorXd& faceValues, double elsewhere);

/// Mean at each vertex of |l / l0 - 1| over its edges in the listed faces; 0 at other vertices.
[[nodiscard]] Eigen::VectorXd vertexStrains(const TriangleMesh& reference,
                                            const Positions& deformed,
                                            std::span<const std::int32_t> faces);

/// A number of an iteration's account.
struct EvolutionColumn {
  std::string name;    ///< of the table's header and of Python's records
  const char* format;  ///< of printf, for a double
  std::function<double(const IterationRecord&)> of;
};

/// All of them but the iteration's number, in the order of the table.
[[nodiscard]] const std::vector<EvolutionColumn>& evolutionColumns();

/// The history as tab-separated text with a header line.
[[nodiscard]] std::string evolutionTable(const std::vector<IterationRecord>& history);

/// A pair of faces that intersects at the start.
struct Crossing {
  geometry::FacePair faces = {-1, -1};
  Point place = Point::Constant(kNaN);  ///< RAS mm, on both faces
  int facesInRegion = 0;                ///< 0 to 2
  bool parted = false;                  ///< by a repair
};

/// The pairs of a surface, those of `left` (sorted) still intersecting after a repair.
[[nodiscard]] std::vector<Crossing> listCrossings(const TriangleMesh& mesh,
                                                  std::span<const geometry::FacePair> pairs,
                                                  std::span<const geometry::FacePair> left,
                                                  const Region& region);

/// Crossings as tab-separated text with a header line.
[[nodiscard]] std::string crossingTable(const TriangleMesh& mesh,
                                        std::span<const Crossing> crossings);

/// Positions as a file with single precision will hold them.
[[nodiscard]] Positions roundedToSingle(const Positions& positions);

/// Demands that single precision, in which files keep positions, holds this surface's edges.
/// @throws InvalidInput  it steps by more than a fiftieth of the mean edge at the farthest vertex;
///                       `name` (a file, an argument) starts the message
void requireFitsSingle(const TriangleMesh& mesh, std::string_view name);

/// Share of the area of the listed faces whose normal looks away from the viewpoints.
[[nodiscard]] double backfacingShare(const TriangleMesh& mesh, std::span<const std::int32_t> faces,
                                     const visibility::Viewpoints& viewpoints);

}  // namespace explica::unfolding
