// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Sulci.h"
#include "Explica/Harmonic/Interpolant.h"

#include <functional>
#include <optional>
#include <vector>

namespace explica::correspondence {

/// Tissue between two boundaries, its buried sulci opened, with its harmonic interpolant: what
/// every thickness, depth, layer and surface is read off, by `TrajectoryTracer`.
struct Ribbon {
  harmonic::Annulus annulus;               ///< with the sheets of buried sulci as boundary
  harmonic::Interpolant interpolant;       ///< per tissue number
  std::vector<std::int32_t> sulcalVoxels;  ///< beside such a sheet
};

/// @param sulcus  nothing: the banks of sulci are left as the labels have them
/// @param onPart  called as each part begins: "sulci", "harmonic"
[[nodiscard]] Ribbon solveRibbon(harmonic::Annulus annulus,
                                 const std::optional<SulcusOptions>& sulcus = SulcusOptions{},
                                 const harmonic::InterpolantOptions& options = {},
                                 const Monitor& monitor = {},
                                 const std::function<void(const char*)>& onPart = {});

}  // namespace explica::correspondence
