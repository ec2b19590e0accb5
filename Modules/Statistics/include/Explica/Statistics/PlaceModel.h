// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Statistics/Contrast.h"
#include "Explica/Statistics/Design.h"

#include <Eigen/Core>

#include <vector>

namespace explica::statistics {

/// One contrast at each of V places; NaN where it cannot be estimated.
struct ContrastMaps {
  Eigen::VectorXd effect;     ///< c^T b in the unit of the values; of an F test partial R^2
  Eigen::VectorXd error;      ///< standard error of the effect; NaN of an F test
  Eigen::VectorXd statistic;  ///< t, or F
  Eigen::VectorXd df;         ///< of the residuals
  Eigen::VectorXd p;          ///< two-sided for t
};

/// A linear model fitted at each of V places by itself.
struct ModelMaps {
  Eigen::MatrixXd coefficients;         ///< p x V
  Eigen::VectorXd variance;             ///< V, of the residuals
  Eigen::VectorXd ratio;                ///< V, the random intercept's variance over `variance`
  Eigen::VectorXi people;               ///< V, with a value
  std::vector<ContrastMaps> contrasts;  ///< in the order of those asked for

  ModelMaps(Eigen::Index columns, Eigen::Index places, std::size_t contrastCount);
};

/// y = X b + e at each place, with e independent, or with an intercept of its own for each group
/// of the design [LairdWare1982], whose variance is found by restricted maximum likelihood.
///
/// A place at which somebody has no value (NaN) is fitted to the others, if their rows of X still
/// have full rank.  Degrees of freedom: n - p; with a random intercept those within groups, n - g -
/// (columns that vary within groups), or between, g - (the other columns), if the contrast has
/// weights on columns of the latter kind only [PinheiroBates2000, 2.4.2].
///
/// @param values  N x B, a column a place
/// @param first   place of the first column in `maps`
void fitPlaces(const Design& design, const std::vector<Contrast>& contrasts,
               const Eigen::MatrixXd& values, Eigen::Index first, ModelMaps& maps);

/// Effect over the residuals' standard deviation: Cohen's d of a difference of two groups.
[[nodiscard]] Eigen::VectorXd standardisedEffect(const ContrastMaps& maps,
                                                 const Eigen::VectorXd& variance);
/// t / sqrt(t^2 + df): of the values with the contrast's regressor, the rest of the model taken off
/// both.
[[nodiscard]] Eigen::VectorXd partialCorrelation(const ContrastMaps& maps);
/// Half the width of the effect's confidence interval of the given level, such as 0.95.
[[nodiscard]] Eigen::VectorXd confidenceHalfWidth(const ContrastMaps& maps, double level);

}  // namespace explica::statistics
