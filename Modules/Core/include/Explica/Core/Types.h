// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <limits>

namespace explica {

using Label = std::int32_t;      ///< value of a segmentation's voxel or of a surface's vertex
using Point = Eigen::Vector3d;   ///< RAS, mm
using Vector = Eigen::Vector3d;  ///< RAS, mm unless the name says otherwise

using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;    ///< V x 3, RAS mm
using Positions2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;   ///< V x 2, mm
using Faces = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< F x 3
using Edges = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 2, Eigen::RowMajor>;  ///< E x 2

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kPi = 3.14159265358979323846;

}  // namespace explica
