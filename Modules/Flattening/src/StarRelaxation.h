// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/MapEnergy.h"

#include <vector>

namespace explica::flattening {

/// A face about a vertex that may move while the two others stay.
struct StarFace {
  RestFace rest;                  ///< gradient[0] is of the vertex that may move
  Eigen::Vector2d second, third;  ///< the others, counter-clockwise after it
};

/// Moves the vertex downhill by damped Newton steps that keep every face positive.
/// @param place  from where every face is positive
[[nodiscard]] Eigen::Vector2d relaxedPlace(const std::vector<StarFace>& star, double areaWeight,
                                           Eigen::Vector2d place, int maxSteps = 10);

}  // namespace explica::flattening
