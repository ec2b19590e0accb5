// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace explica::surface {

/// How a surface that has grown out of another one gets even triangles back.
struct RelaxationOptions {
  int sweeps = 16;
  int lastSweeps = 24;  ///< that bring the last needles and spikes to the middle of their rings
  double bend = 0.3;    ///< share of the way to the ring's mean that is taken across the surface
  double most = 0.2;    ///< farthest that a vertex may leave its surface across it, mm
};

/// Where a point belongs: the nearest one of the surface's own, given the outward normal there.
using Placement =
    std::function<Point(std::int32_t vertex, const Point& point, const Vector& normal)>;

/// Where triangles are stretched, poor or folded, lets vertices slide along their surface to the
/// middle of their neighbours, so that neither crowns nor floors keep the triangles that growth has
/// left them; what stands out from the ring goes back; vertices of a rim slide along it.  Faces
/// stay, and no step makes them meet.  Elsewhere nothing moves.
/// @param edge   mean edge, mm
/// @param moves  1 for the vertices that may move
[[nodiscard]] TriangleMesh relaxed(const TriangleMesh& mesh, double edge,
                                   const std::vector<std::uint8_t>& moves, const Placement& place,
                                   const RelaxationOptions& options = {});

}  // namespace explica::surface
