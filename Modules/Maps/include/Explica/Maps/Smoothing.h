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
[[nodiscard]] Eigen::MatrixXd smoothMaps(const TriangleMesh& mesh, Eigen::MatrixXd values,
                                         double fwhm, const std::vector<bool>& mask = {},
                                         const Monitor& monitor = {});

/// Smoothness of noise on a surface: the full width at half maximum, mm, of the Gaussian kernel
/// that gives white noise the mean squared difference across edges that the maps have.
///
/// With one map its values about their mean are taken, with several the residuals about the mean
/// map.  A noise of correlation rho(d) = exp(-2 ln 2 d^2 / fwhm^2) has the mean squared difference
/// 2 (1 - rho(d)) of its variance across an edge of length d [Worsley1999]; the sum over edges is
/// solved for fwhm as it is, without the limit d -> 0.
///
/// @param values  V x n; a vertex counts where it is marked and all maps are finite
/// @return NaN where nothing varies; 0 where neighbours are not correlated
[[nodiscard]] double estimateFwhm(const TriangleMesh& mesh, const Eigen::MatrixXd& values,
                                  const std::vector<bool>& mask = {});

}  // namespace explica::maps
