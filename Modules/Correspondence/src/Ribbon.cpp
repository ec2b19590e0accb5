// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Ribbon.h"

#include <utility>

namespace explica::correspondence {

Ribbon solveRibbon(harmonic::Annulus annulus, const std::optional<SulcusOptions>& sulcus,
                   const harmonic::InterpolantOptions& options, const Monitor& monitor,
                   const std::function<void(const char*)>& onPart) {
  Ribbon ribbon;
  ribbon.annulus = std::move(annulus);
  if (sulcus) {
    if (onPart) onPart("sulci");
    SulcalRecovery recovered =
        recoverSulci(std::move(ribbon.annulus), *sulcus, monitor.part(0, 0.2));
    ribbon.annulus = std::move(recovered.annulus);
    ribbon.sulcalVoxels = std::move(recovered.voxels);
  }
  if (onPart) onPart("harmonic");
  ribbon.interpolant = harmonic::solveInterpolant(ribbon.annulus, options, monitor.part(0.2, 1));
  return ribbon;
}

}  // namespace explica::correspondence
