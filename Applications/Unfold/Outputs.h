// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Unfolding/Unfold.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <vector>

namespace explica::app {

inline constexpr char kReferenceFile[] = "reference.surf.gii";
inline constexpr char kUnfoldingState[] = "unfolding.state";

/// A finished unfolding and what it came from.
struct Unfolded {
  std::string reference = "SURFACE";  ///< the file of `before`, if it was repaired its own
  TriangleMesh before;  ///< the whole surface, its crossings parted as far as that was asked for
  io::SurfaceMetadata metadata;
  visibility::Viewpoints view;
  unfolding::Region chosen;                   ///< of `before`
  std::vector<geometry::FacePair> crossings;  ///< of `before`, sorted
  visibility::VisibleFraction seenBefore;
  unfolding::UnfoldResult result;
  unfolding::Surround surround = unfolding::Surround::Elastic;
  double goal = 1;  ///< of the visibility
  double secondsStart = 0;
};

/// Writes all files, and the numbers of the summary, about the surface as the files hold it.
/// @return how the run ended; Stalled if faces cross that did not at the start
[[nodiscard]] Termination writeUnfolded(Context& context, Unfolded& u);

}  // namespace explica::app
