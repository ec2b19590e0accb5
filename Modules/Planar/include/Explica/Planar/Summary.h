// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/PolygonUnfolding.h"

#include <vector>

namespace explica::planar {

/// A polygon in numbers, whatever the viewpoint.
struct PolygonSummary {
  int regionEdges = 0;
  double length = kNaN;       ///< of the region, mm
  double area = kNaN;         ///< signed, mm^2
  std::size_t crossings = 0;  ///< pairs of edges
};

/// An unfolding of a polygon in numbers.
struct PolygonUnfoldSummary {
  std::vector<double> viewpoints, weights;
  double target = 1;            ///< visibility that was asked for
  bool keepsLength = true;      ///< of the region's edges
  PolygonIteration start, end;  ///< of the history
  VisiblePart before, after;
  std::size_t crossings = 0;  ///< pairs of edges
  int firstCrossing = -1;
  int verticesMerged = 0;
  double seconds = 0, secondsTopology = 0;
  Termination stopReason = Termination::NotRun;
};

void describe(Results& t, const PolygonSummary& s);
void describe(Results& t, const PolygonUnfoldSummary& s);

}  // namespace explica::planar
