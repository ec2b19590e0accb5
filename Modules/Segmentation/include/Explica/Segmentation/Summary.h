// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Segmentation/Disagreement.h"
#include "Explica/Segmentation/Hemisphere.h"
#include "Explica/Segmentation/Tissue.h"

namespace explica::segmentation {

/// A hemisphere's voxels, without its volumes.
struct HemisphereCounts {
  std::int64_t white = 0, grey = 0, deep = 0, ventricle = 0, cavity = 0, stray = 0;
};
[[nodiscard]] HemisphereCounts countsOf(const Hemisphere& hemisphere);

/// The tissues of a T1 and its hemispheres, in numbers.
struct TissueSummary {
  const TissueSegmentation* tissue = nullptr;  ///< not owned
  std::optional<double> rimContrast;           ///< rimContrast()
  std::optional<double> greyAtMaskEdge;        ///< greyAtMaskEdge()
  std::optional<Disagreement> template_;       ///< with a template
  std::optional<Side> side;
  std::optional<HemisphereCounts> one, left, right;  ///< `one` where only one side was asked for
};

/// Lists what is known in summary.json.
void describe(Results& t, const TissueSummary& r);

}  // namespace explica::segmentation
