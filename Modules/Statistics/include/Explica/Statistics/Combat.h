// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace explica::statistics {

/// A column for each site, of 0 and 1, and the covariates.
/// @param sites  N, from 0
[[nodiscard]] Eigen::MatrixXd withSites(const std::vector<int>& sites,
                                        const Eigen::MatrixXd& covariates);

/// What harmonisation did to the sites.
struct CombatResult {
  Eigen::MatrixXd shift;  ///< S x V, in units of `spread`, taken off each site's people
  Eigen::MatrixXd scale;  ///< S x V, by which the rest is divided
};

/// Takes differences of sites in mean and variance off the values, keeping what covariates explain
/// [Johnson2007, Fortin2018]: each place's site effects are shrunk towards the site's mean over all
/// places (empirical Bayes, normal and inverse gamma priors with moments of the places).
/// @param values      N x V, changed in place; a place with a missing value is left as it is
/// @param covariates  N x k, to be kept, without an intercept
/// @param sites       N, from 0
/// @throws InvalidInput  fewer than two sites, a site with one person, a single usable place
CombatResult combat(Eigen::MatrixXd& values, const Eigen::MatrixXd& covariates,
                    const std::vector<int>& sites);

}  // namespace explica::statistics
