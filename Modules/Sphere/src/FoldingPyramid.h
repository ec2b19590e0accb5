// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/SphereLocator.h"
#include "Explica/Sphere/Register.h"

#include <memory>
#include <vector>

namespace explica::sphere {

/// Folding maps on one icosphere: sulcal depth and curvature.
struct FoldingLevel {
  std::shared_ptr<const geometry::SphereLocator> grid;  ///< of radius 1
  std::array<Eigen::VectorXd, 2> maps;                  ///< of mean 0 and variance 1
  std::array<Eigen::VectorXd, 2> weights;               ///< 1 / variance, of mean 1
};

/// Maps on icospheres 0 to `level`, each level smoothed before it is thinned out to the coarser.
[[nodiscard]] std::vector<FoldingLevel> foldingPyramid(const FoldingSphere& folding, int level);

/// Values of a map of a spherical mesh at places given by directions.
[[nodiscard]] Eigen::VectorXd valuesAt(const geometry::SphereLocator& locator,
                                       const Eigen::VectorXd& values, const Positions& directions);

}  // namespace explica::sphere
