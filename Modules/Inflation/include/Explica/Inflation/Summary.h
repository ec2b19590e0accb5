// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Comparison.h"
#include "Explica/Unfolding/Summary.h"

namespace explica::inflation {

/// An inflation in numbers, of the surface as files hold it.
struct InflateSummary {
  Eigen::Index faces = 0, vertices = 0;
  double area = kNaN;  ///< mm^2, of the start
  Change volume;       ///< mm^3
  int viewpoints = 0;
  double target = 1;  ///< global visibility that was asked for
  Change visibility, seen;
  unfolding::Distortion distortion;
  flattening::DistanceErrors distances;
  std::int64_t turnedOver = 0;
  unfolding::FrameSummary frames;
  double drive = kNaN;
  unfolding::PhaseSeconds phases;
  std::size_t crossings = 0, crossingsNew = 0;  ///< pairs of faces
  unfolding::EndSummary end;
};

void describe(Results& t, const InflateSummary& s);

}  // namespace explica::inflation
