// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Comparison.h"
#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/Flatten.h"
#include "Explica/Unfolding/Distortion.h"

namespace explica::unfolding {

/// A flat map in numbers.
struct FlatSummary {
  const flattening::Disc* disc = nullptr;    ///< must outlive this
  const flattening::FlatMap* map = nullptr;  ///< must outlive this
  Distortion distortion;
  flattening::DistanceErrors distances;
  double area = kNaN;           ///< mm^2
  double areaTolerance = kNaN;  ///< mean area error that was asked for
  std::optional<std::int64_t> turnedOverInFrames = 0;
};

void describe(Results& t, const FlatSummary& s);

}  // namespace explica::unfolding
