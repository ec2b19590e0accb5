// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Combat.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Types.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace explica::statistics {
namespace {

constexpr double kSettled = 1e-9;  // relative change of a site's shift and scale between rounds
constexpr int kRounds = 10000;     // at most; each shortens the distance to the fixed point

/// Moments over places of one site: priors of its shift and its variance.
struct Prior {
  double mean, variance;  // normal, of the shift
  double shape, rate;     // inverse gamma, of the variance
};

Prior priorOf(const Eigen::VectorXd& mean, const Eigen::VectorXd& variance) {
  const auto count = static_cast<double>(mean.size() - 1);
  const double m = variance.mean(), s = (variance.array() - m).square().sum() / count;
  const double centre = mean.mean();
  return {centre, (mean.array() - centre).square().sum() / count, (2 * s + m * m) / s,
          (m * s + m * m * m) / s};
}

/// Posterior shift and variance of a site at one place.
std::pair<double, double> posterior(double mean, double variance, double n, const Prior& prior) {
  double shift = mean, scale = variance;
  for (int round = 0; round < kRounds; ++round) {
    const double newShift =
        (n * prior.variance * mean + scale * prior.mean) / (n * prior.variance + scale);
    const double squares = (n - 1) * variance + n * (mean - newShift) * (mean - newShift);
    const double newScale = (prior.rate + squares / 2) / (n / 2 + prior.shape - 1);
    const double change = std::max(std::abs(newShift - shift) / std::max(std::abs(shift), kSettled),
                                   std::abs(newScale - scale) / scale);
    shift = newShift;
    scale = newScale;
    if (change < kSettled) break;
  }
  return {shift, scale};
}

std::vector<double> countsOf(const std::vector<int>& sites) {
  std::vector<double> counts(
      static_cast<std::size_t>(1 + *std::max_element(sites.begin(), sites.end())));
  for (const int s : sites) ++counts[s];
  if (counts.size() < 2) throw InvalidInput("--site combat: there is one site");
  if (*std::min_element(counts.begin(), counts.end()) < 2) {
    throw InvalidInput("--site combat: a site has one person, so that its spread is not known");
  }
  return counts;
}

/// Values standardised place by place, with what makes them values again.
struct Standardised {
  Eigen::MatrixXd z;       // N x W, of the usable places
  Eigen::MatrixXd fitted;  // N x W, grand mean and covariates
  Eigen::VectorXd spread;  // W
  std::vector<Eigen::Index> places;
};

Standardised standardise(const Eigen::MatrixXd& values, const Eigen::MatrixXd& covariates,
                         const std::vector<int>& sites, const std::vector<double>& counts) {
  const auto n = static_cast<double>(values.rows());
  const auto s = static_cast<Eigen::Index>(counts.size());
  const Eigen::MatrixXd design = withSites(sites, covariates);
  Standardised result;
  for (Eigen::Index v = 0; v < values.cols(); ++v) {
    if (values.col(v).allFinite()) result.places.push_back(v);
  }
  const Eigen::Map<const Eigen::VectorXd> weights(counts.data(), s);
  const Eigen::MatrixXd y = values(Eigen::all, result.places);
  const Eigen::MatrixXd b = design.householderQr().solve(y);
  const Eigen::RowVectorXd grand = weights.transpose() * b.topRows(s) / n;
  result.fitted = covariates * b.bottomRows(covariates.cols());
  result.fitted.rowwise() += grand;
  result.spread = ((y - design * b).colwise().squaredNorm() / n).cwiseSqrt().transpose();
  result.z = (y - result.fitted).array().rowwise() / result.spread.transpose().array();
  return result;
}

}  // namespace

Eigen::MatrixXd withSites(const std::vector<int>& sites, const Eigen::MatrixXd& covariates) {
  const int count = 1 + *std::ranges::max_element(sites);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(covariates.rows(), count + covariates.cols());
  for (std::size_t i = 0; i < sites.size(); ++i) all(i, sites[i]) = 1;
  all.rightCols(covariates.cols()) = covariates;
  return all;
}

CombatResult combat(Eigen::MatrixXd& values, const Eigen::MatrixXd& covariates,
                    const std::vector<int>& sites) {
  const auto counts = countsOf(sites);
  const auto s = static_cast<Eigen::Index>(counts.size());
  const Standardised standard = standardise(values, covariates, sites, counts);
  const auto places = static_cast<Eigen::Index>(standard.places.size());
  if (places < 2) {
    throw InvalidInput("--site combat: learns from many places; of one, use --site fixed");
  }
  CombatResult result{Eigen::MatrixXd::Zero(s, values.cols()),
                      Eigen::MatrixXd::Ones(s, values.cols())};
  for (Eigen::Index site = 0; site < s; ++site) {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(places), variance = mean;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (sites[i] == site) mean += standard.z.row(i);
    }
    mean /= counts[site];
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (sites[i] == site) variance += (standard.z.row(i) - mean).cwiseAbs2();
    }
    variance /= counts[site] - 1;
    const Prior prior = priorOf(mean, variance);
    for (Eigen::Index w = 0; w < places; ++w) {
      const auto [shift, scale] = posterior(mean[w], variance[w], counts[site], prior);
      result.shift(site, standard.places[w]) = shift;
      result.scale(site, standard.places[w]) = std::sqrt(scale);
    }
  }
  for (Eigen::Index w = 0; w < places; ++w) {
    const Eigen::Index v = standard.places[w];
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      const int site = sites[i];
      values(i, v) = standard.fitted(i, w) + standard.spread[w] *
                                                 (standard.z(i, w) - result.shift(site, v)) /
                                                 result.scale(site, v);
    }
  }
  return result;
}

}  // namespace explica::statistics
