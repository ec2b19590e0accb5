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

/// Means and variances of each site at each place, standardised.
struct SiteMoments {
  Eigen::MatrixXd mean, variance;  // S x V
};

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
  for (const int s : sites) ++counts[static_cast<std::size_t>(s)];
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
  const Eigen::Index n = values.rows();
  const auto s = static_cast<Eigen::Index>(counts.size());
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(n, s + covariates.cols());
  for (Eigen::Index i = 0; i < n; ++i) design(i, sites[static_cast<std::size_t>(i)]) = 1;
  design.rightCols(covariates.cols()) = covariates;
  Standardised result;
  for (Eigen::Index v = 0; v < values.cols(); ++v) {
    if (values.col(v).allFinite()) result.places.push_back(v);
  }
  const Eigen::Map<const Eigen::VectorXd> weights(counts.data(), s);
  const Eigen::MatrixXd y = values(Eigen::all, result.places);
  const Eigen::MatrixXd b = design.householderQr().solve(y);
  const Eigen::RowVectorXd grand = weights.transpose() * b.topRows(s) / static_cast<double>(n);
  result.fitted = covariates * b.bottomRows(covariates.cols());
  result.fitted.rowwise() += grand;
  result.spread =
      ((y - design * b).colwise().squaredNorm() / static_cast<double>(n)).cwiseSqrt().transpose();
  result.z = (y - result.fitted).array().rowwise() / result.spread.transpose().array();
  return result;
}

SiteMoments momentsOf(const Eigen::MatrixXd& z, const std::vector<int>& sites,
                      const std::vector<double>& counts) {
  const auto s = static_cast<Eigen::Index>(counts.size());
  const Eigen::Map<const Eigen::ArrayXd> n(counts.data(), s);
  SiteMoments moments{Eigen::MatrixXd::Zero(s, z.cols()), Eigen::MatrixXd::Zero(s, z.cols())};
  for (Eigen::Index i = 0; i < z.rows(); ++i) {
    moments.mean.row(sites[static_cast<std::size_t>(i)]) += z.row(i);
  }
  moments.mean.array().colwise() /= n;
  for (Eigen::Index i = 0; i < z.rows(); ++i) {
    const int site = sites[static_cast<std::size_t>(i)];
    moments.variance.row(site) += (z.row(i) - moments.mean.row(site)).cwiseAbs2();
  }
  moments.variance.array().colwise() /= n - 1;
  return moments;
}

}  // namespace

CombatResult combat(Eigen::MatrixXd& values, const Eigen::MatrixXd& covariates,
                    const std::vector<int>& sites) {
  const auto counts = countsOf(sites);
  const auto s = static_cast<Eigen::Index>(counts.size());
  const Standardised standard = standardise(values, covariates, sites, counts);
  const auto places = static_cast<Eigen::Index>(standard.places.size());
  if (places < 2) {
    throw InvalidInput("--site combat: learns from many places; of one, use --site fixed");
  }
  const SiteMoments moments = momentsOf(standard.z, sites, counts);
  CombatResult result{Eigen::MatrixXd::Zero(s, values.cols()),
                      Eigen::MatrixXd::Ones(s, values.cols())};
  for (Eigen::Index site = 0; site < s; ++site) {
    const Prior prior = priorOf(moments.mean.row(site), moments.variance.row(site));
    for (Eigen::Index w = 0; w < places; ++w) {
      const auto [shift, scale] = posterior(moments.mean(site, w), moments.variance(site, w),
                                            counts[static_cast<std::size_t>(site)], prior);
      result.shift(site, standard.places[static_cast<std::size_t>(w)]) = shift;
      result.scale(site, standard.places[static_cast<std::size_t>(w)]) = std::sqrt(scale);
    }
  }
  for (Eigen::Index w = 0; w < places; ++w) {
    const Eigen::Index v = standard.places[static_cast<std::size_t>(w)];
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      const int site = sites[static_cast<std::size_t>(i)];
      values(i, v) = standard.fitted(i, w) + standard.spread[w] *
                                                 (standard.z(i, w) - result.shift(site, v)) /
                                                 result.scale(site, v);
    }
  }
  return result;
}

}  // namespace explica::statistics
