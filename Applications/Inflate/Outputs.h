// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Inflation/Inflate.h"

#include <vector>

namespace explica::app {

inline constexpr char kInflationState[] = "inflation.state";

/// A finished inflation and what it came from.
struct Inflated {
  TriangleMesh before;  ///< its crossings parted as far as that was asked for
  io::SurfaceMetadata metadata;
  std::vector<geometry::FacePair> crossings;  ///< of `before`, sorted
  inflation::InflateResult result;
};

/// Writes all files, and the numbers of the summary, about the surface as the files hold it.
/// @return how the run ended; Stalled if faces cross that did not at the start
[[nodiscard]] Termination writeInflated(Context& context, Inflated& u,
                                        const inflation::InflateOptions& options);

}  // namespace explica::app
