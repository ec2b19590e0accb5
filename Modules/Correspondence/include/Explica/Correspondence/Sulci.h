// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Harmonic/Annulus.h"

#include <vector>

namespace explica::correspondence {

/// When two fronts that meet in grey matter are taken for the banks of a sulcus.
struct SulcusOptions {
  double facingDeg = 100;  ///< smallest angle between the fronts' directions: more than a right
                           ///< angle, at which they meet in a right-angled corner of one bank, by
                           ///< the ten degrees to which directions are known a voxel or two away
};

template <class Visitor>
void describe(SulcusOptions& options, Visitor&& visit) {
  visit(
      Field{"facing", "degrees",
            "smallest angle between two fronts from the inner boundary whose meeting is a sulcus"},
      options.facingDeg);
}

/// The tissue with its hidden outer boundary.
struct SulcalRecovery {
  harmonic::Annulus annulus;         ///< with the sheets between opposite banks as boundary
  std::vector<Point> sheet;          ///< RAS mm: where the sheets cross the grid's lines
  std::vector<std::int32_t> voxels;  ///< of `annulus`: tissue voxels with a link that was cut
};

/// Finds sulci whose banks touch, so that the labels show no gap between them.
///
/// Fronts leave the inner boundary at equal speed (nearest point of the boundary, carried from
/// voxel to voxel through the tissue).  Where two neighbouring voxels were reached by fronts that
/// face each other, the outer boundary is put between them where both are equally far: a sheet
/// without thickness, placed between the voxels, that takes no voxel away.  Cf. [Han2004,
/// section 3.3], where whole voxels are removed.
[[nodiscard]] SulcalRecovery recoverSulci(harmonic::Annulus annulus,
                                          const SulcusOptions& options = {},
                                          const Monitor& monitor = {});

}  // namespace explica::correspondence
