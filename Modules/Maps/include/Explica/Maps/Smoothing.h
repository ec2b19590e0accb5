// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/TriangleMesh.h"

#include <vector>

namespace explica::maps {

/// Maps diffused along a surface until a point source in a plane has the full width at half maximum
/// `fwhm` mm, as a Gaussian of variance fwhm^2 / (8 ln 2) along each direction.
///
/// The variance of the kernel is that of the Gaussian on any mesh; waves of a few edges decay more
/// slowly, so that noise smoothed by four edges is 6 % rougher than `fwhm` says, by ten 1 %.
/// NaN stays NaN and conducts nothing; vertices off `mask` keep their values and conduct nothing.
/// The integral of each map over the faces that conduct stays.
///
/// @param values  V x n
/// @param mask    V marks, or empty for all
/// @throws InvalidInput  sizes that do not match, or fwhm not above 0
/// @throws Interrupted   the monitor asks for an end
[[nodiscard]] Eigen::MatrixXd smoothMaps(const TriangleMesh& mesh, Eigen::MatrixXd values,
                                         double fwhm, const std::vector<bool>& mask = {},
                                         const Monitor& monitor = {});

/// Smoothness of noise on a surface: the full width at half maximum, mm, of the Gaussian kernel
/// that would give it to white noise.
///
/// Of five maps or more: the residuals about the mean map, scaled to length 1 at each vertex, span
/// a triangle for each face; the sum of these triangles' areas over 4 ln 2 is the number of resels,
/// and the surface's area over it the squared width [Worsley1999], as SurfStat and BrainStat have
/// it.  Of fewer maps: the mean squared slope along edges over the variance about each map's mean.
///
/// @param values  V x n; a vertex counts where it is marked and all maps are finite
/// @return NaN where nothing varies
[[nodiscard]] double estimateFwhm(const TriangleMesh& mesh, const Eigen::MatrixXd& values,
                                  const std::vector<bool>& mask = {});

}  // namespace explica::maps
