// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Core/Types.h"

#include <string>

namespace explica::app {

/// Sessions in a common space and what changed between the first and the last, in numbers.
struct Change {
  std::int64_t sessions = 0;
  double voxels = kNaN, correlation = kNaN, turn = kNaN;
  double mean = kNaN, deviation = kNaN, known = kNaN;
};

void describe(Results& t, const Change& r);

/// "session-1" of the first.
inline std::string numbered(const char* stem, std::size_t session) {
  return stem + std::to_string(session + 1);
}

/// One hemisphere, as the template's run has named it.
struct MeasuredSide {
  std::string ending, letter;
  [[nodiscard]] std::string structure() const {
    return letter == "L" ? "CortexLeft" : "CortexRight";
  }
};

/// Sums over the area of both hemispheres.
struct Sums {
  double all = 0, known = 0, first = 0, second = 0;

  void add(const Eigen::VectorXd& areas, const Eigen::VectorXd& change);
  /// Mean, deviation and share of what is known.
  void settle(Change& change) const;
};

/// Maps of a hemisphere's thickness at the vertices of the mean's middle surface, and the table of
/// its regions.
/// @param person  in the table
/// @param voxel   mm
void measureChange(Context& context, std::size_t sessions, const MeasuredSide& side,
                   const std::string& person, double voxel, Sums& sums);

}  // namespace explica::app
