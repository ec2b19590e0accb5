// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Annulus.h"
#include "Explica/Harmonic/Interpolant.h"

#include <vector>

namespace explica::correspondence {

/// One line across which a slice's tissue is half way, and where the trajectories through it begin
/// and end: point k of each list belongs to point k of the others.
struct Contour {
  int slice = 0;                            ///< along k
  bool closed = false;                      ///< the last point is followed by the first
  std::vector<Point> inner, middle, outer;  ///< RAS mm; middle at half the trajectory's length
  std::vector<double> thickness;            ///< length of the trajectory, mm
};

/// Inner, middle and outer contours of tissue whose slices stand alone: where the interpolant is
/// one half, with edges of about a voxel, and from there along the trajectories.  Lines end where
/// the tissue does; points whose trajectory does not reach both boundaries are left out.  Contours
/// of less than three points are none.  Ordered by slice.
/// @param annulus  planar
/// @throws InvalidInput  the annulus is not planar
[[nodiscard]] std::vector<Contour> contoursOf(const harmonic::Annulus& annulus,
                                              const harmonic::Interpolant& interpolant);

}  // namespace explica::correspondence
