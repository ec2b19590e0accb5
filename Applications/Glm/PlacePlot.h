// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Results.h"

#include <string>
#include <vector>

namespace explica::app {

/// A peak or region whose plot the page offers by name.
struct NamedPlace {
  std::size_t contrast;
  Eigen::Index place;
};

/// Each person at a place, as a section with script and data: at those that are named, and at
/// whatever place is clicked on the page's surface.  Of so many people that their values at all
/// places would make a page of more than some MB, of places evenly among them.
[[nodiscard]] std::string placePlot(const Observations& observations, const GlmResults& results,
                                    const std::vector<NamedPlace>& named);

}  // namespace explica::app
