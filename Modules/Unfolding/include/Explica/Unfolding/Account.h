// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Unfolding/Unfolder.h"

#include <span>
#include <string>
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

/// The history as tab-separated text with a header line.
[[nodiscard]] std::string evolutionTable(const std::vector<IterationRecord>& history);

/// Positions as a file with single precision will hold them.
[[nodiscard]] Positions roundedToSingle(const Positions& positions);

/// Share of the area of the listed faces whose normal looks away from the viewpoints.
[[nodiscard]] double backfacingShare(const TriangleMesh& mesh, std::span<const std::int32_t> faces,
                                     const visibility::Viewpoints& viewpoints);

}  // namespace explica::unfolding
