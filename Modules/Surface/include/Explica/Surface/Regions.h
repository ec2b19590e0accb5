// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"

#include <functional>
#include <vector>

namespace explica::surface {

using VertexKeys = Eigen::Matrix<Label, Eigen::Dynamic, 1>;  ///< V

/// Label of an atlas at each vertex of a ribbon: that of the voxel at half depth, else at a quarter
/// and three quarters, else at the white and the outer surface; 0 where none of them counts.
/// @param counts  which labels are cortical regions
[[nodiscard]] VertexKeys labelsWithin(const Volume<Label>& atlas, const Positions& white,
                                      const Positions& pial,
                                      const std::function<bool(Label)>& counts);

/// One region of the cortex.
struct RegionMeasure {
  Label key = 0;
  Eigen::Index vertices = 0;      ///< with this key
  double area = 0;                ///< mm^2
  double thicknessMean = 0;       ///< mm, weighted; NaN where no vertex has a thickness
  double thicknessDeviation = 0;  ///< standard deviation, mm
};

/// Area and thickness of each region, ascending keys, 0 left out.  Vertices without thickness (0)
/// count for the area, not for the mean.
/// @param areas    V, mm^2
/// @param weights  V, of the thickness: areas of the middle surface
[[nodiscard]] std::vector<RegionMeasure> measureRegions(const VertexKeys& keys,
                                                        const Eigen::VectorXd& thickness,
                                                        const Eigen::VectorXd& areas,
                                                        const Eigen::VectorXd& weights);

}  // namespace explica::surface
