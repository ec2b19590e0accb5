// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "RibbonPaths.h"

#include <vector>

namespace explica::surface {

/// Less than this is no shortfall, voxels: what the border itself is uncertain by.
inline constexpr double kNoShortfall = 0.02;

/// Vertices on their trajectories, advancing together and never through each other.
class Growth {
 public:
  /// @param paths  one for each vertex of `white`, which must outlive this
  Growth(const TriangleMesh& white, const std::vector<Trajectory>& paths);

  /// Takes every vertex as near to a share of its way as its faces allow.
  void goTo(double share);

  /// How far a vertex fell short of the share that was asked for last, mm.
  [[nodiscard]] double missing(std::size_t v) const { return share_ * lengths_[v] - reached_[v]; }
  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
  geometry::SelfIntersectionSearch search_;
  const std::vector<Trajectory>& paths_;
  std::vector<double> lengths_, reached_;
  double share_ = 0;
};

}  // namespace explica::surface
