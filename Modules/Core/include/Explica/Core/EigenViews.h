// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <Eigen/Geometry>

#include <vector>

namespace explica {

/// The same numbers for Eigen, as long as they stay where they are.
[[nodiscard]] inline Eigen::Map<const Eigen::VectorXd> asVector(const std::vector<double>& list) {
  return {list.data(), static_cast<Eigen::Index>(list.size())};
}

/// The box of some points; empty if there is none.
[[nodiscard]] inline Eigen::AlignedBox3d boundingBox(const Positions& points) {
  if (points.rows() == 0) return {};
  return {points.colwise().minCoeff().transpose(), points.colwise().maxCoeff().transpose()};
}

}  // namespace explica
