// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/PlaceModel.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Types.h"
#include "Explica/Statistics/Distributions.h"
#include "RandomIntercept.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace explica::statistics {
namespace {

/// People of a place with a value, and what solves their model.
struct Rows {
  Eigen::MatrixXd design;
  std::vector<int> groups;  // numbered from 0 without gaps, or empty
  int groupCount = 0;
  std::vector<bool> within;  // columns of theirs that vary within groups
  Eigen::MatrixXd inverse;   // (X^T X)^-1; empty with groups
  Eigen::MatrixXd solver;    // p x N, (X^T X)^-1 X^T
};

std::vector<bool> variesWithin(const Eigen::MatrixXd& design, const std::vector<int>& groups,
                               int count) {
  std::vector<bool> varies(static_cast<std::size_t>(design.cols()), false);
  for (Eigen::Index c = 0; c < design.cols(); ++c) {
    std::vector<double> first(static_cast<std::size_t>(count), kNaN);
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      double& known = first[groups[i]];
      if (std::isnan(known)) known = design(i, c);
      if (known != design(i, c)) varies[c] = true;
    }
  }
  return varies;
}

Rows rowsOf(const Design& design, const std::vector<Eigen::Index>& people) {
  Rows rows;
  rows.design = design.matrix(people, Eigen::all);
  if (design.groups.empty()) {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows.design);
    const Eigen::Index p = rows.design.cols();
    const Eigen::MatrixXd upper =
        qr.matrixQR().topLeftCorner(p, p).triangularView<Eigen::Upper>().solve(
            Eigen::MatrixXd::Identity(p, p));
    rows.inverse = upper * upper.transpose();
    rows.solver = rows.inverse * rows.design.transpose();
    return rows;
  }
  std::vector<int> number(design.groups.size(), -1);
  for (const Eigen::Index person : people) {
    int& known = number[design.groups[person]];
    if (known < 0) known = rows.groupCount++;
    rows.groups.push_back(known);
  }
  rows.within = variesWithin(rows.design, rows.groups, rows.groupCount);
  return rows;
}

/// Degrees of freedom of a contrast's residual variance.
double dfOf(const Contrast& contrast, const Rows& rows) {
  const auto n = static_cast<double>(rows.design.rows()),
             p = static_cast<double>(rows.design.cols());
  if (rows.groups.empty()) return n - p;
  double within = 0;
  bool onlyBetween = true;
  for (Eigen::Index c = 0; c < rows.design.cols(); ++c) {
    if (!rows.within[c]) continue;
    ++within;
    if (!contrast.weights.row(c).isZero()) onlyBetween = false;
  }
  return onlyBetween ? rows.groupCount - (p - within) : n - rows.groupCount - within;
}

/// Fills place v of a contrast from the place's fit.
void evaluate(const Contrast& contrast, const PlaceFit& fit, double df, Eigen::Index v,
              ContrastMaps& maps) {
  if (!(df > 0)) return;
  const Eigen::VectorXd effect = contrast.weights.transpose() * fit.coefficients;
  const Eigen::MatrixXd spread = contrast.weights.transpose() * fit.inverse * contrast.weights;
  maps.df[v] = df;
  if (contrast.isT()) {
    maps.effect[v] = effect[0];
    maps.error[v] = std::sqrt(spread(0, 0) * fit.variance);
    maps.statistic[v] = effect[0] / maps.error[v];
    maps.p[v] = tTwoSided(maps.statistic[v], df);
    return;
  }
  const auto r = static_cast<double>(effect.size());
  const double explained = effect.dot(spread.ldlt().solve(effect));
  maps.statistic[v] = explained / r / fit.variance;
  maps.effect[v] = explained / (explained + df * fit.variance);
  maps.p[v] = fTail(maps.statistic[v], r, df);
}

PlaceFit solve(const Rows& rows, const Eigen::VectorXd& y) {
  if (!rows.groups.empty()) return fitRandomIntercept(rows.design, y, rows.groups);
  PlaceFit fit{rows.solver * y, rows.inverse};
  // A second round takes off what rounding left in the span of the design.
  fit.coefficients += rows.solver * (y - rows.design * fit.coefficients);
  fit.variance = (y - rows.design * fit.coefficients).squaredNorm() /
                 static_cast<double>(rows.design.rows() - rows.design.cols());
  return fit;
}

void fitPlace(const Rows& rows, const std::vector<Contrast>& contrasts, const Eigen::VectorXd& y,
              Eigen::Index v, ModelMaps& maps) {
  const PlaceFit fit = solve(rows, y);
  maps.coefficients.col(v) = fit.coefficients;
  maps.variance[v] = fit.variance;
  maps.ratio[v] = fit.ratio;
  for (std::size_t k = 0; k < contrasts.size(); ++k) {
    evaluate(contrasts[k], fit, dfOf(contrasts[k], rows), v, maps.contrasts[k]);
  }
}

}  // namespace

ModelMaps::ModelMaps(Eigen::Index columns, Eigen::Index places, std::size_t contrastCount)
    : coefficients(Eigen::MatrixXd::Constant(columns, places, kNaN)),
      variance(Eigen::VectorXd::Constant(places, kNaN)),
      ratio(variance),
      people(Eigen::VectorXi::Zero(places)),
      contrasts(contrastCount, ContrastMaps{variance, variance, variance, variance, variance}) {}

void fitPlaces(const Design& design, const std::vector<Contrast>& contrasts,
               const Eigen::MatrixXd& values, Eigen::Index first, ModelMaps& maps) {
  std::vector<Eigen::Index> everybody(static_cast<std::size_t>(design.people()));
  std::iota(everybody.begin(), everybody.end(), 0);
  const Rows all = rowsOf(design, everybody);
  parallelFor(static_cast<std::size_t>(values.cols()), 64, [&](std::size_t b) {
    const Eigen::VectorXd y = values.col(b);
    const Eigen::Index v = first + static_cast<Eigen::Index>(b);
    std::vector<Eigen::Index> people;
    std::ranges::copy_if(everybody, std::back_inserter(people),
                         [&](Eigen::Index i) { return std::isfinite(y[i]); });
    maps.people[v] = static_cast<int>(people.size());
    if (maps.people[v] == y.size()) return fitPlace(all, contrasts, y, v, maps);
    const Eigen::MatrixXd known = design.matrix(people, Eigen::all);
    if (known.rows() <= known.cols()) return;
    if (known.colPivHouseholderQr().rank() < known.cols()) return;
    fitPlace(rowsOf(design, people), contrasts, y(people), v, maps);
  });
}

Eigen::VectorXd standardisedEffect(const ContrastMaps& maps, const Eigen::VectorXd& variance) {
  return maps.effect.array() / variance.array().sqrt();
}

Eigen::VectorXd partialCorrelation(const ContrastMaps& maps) {
  const auto t = maps.statistic.array();
  return t / (t.square() + maps.df.array()).sqrt();
}

Eigen::VectorXd confidenceHalfWidth(const ContrastMaps& maps, double level) {
  Eigen::VectorXd width(maps.error.size());
  double df = kNaN, quantile = kNaN;
  for (Eigen::Index v = 0; v < width.size(); ++v) {
    if (maps.df[v] != df) {
      df = maps.df[v];
      quantile = tQuantile((1 - level) / 2, df);
    }
    width[v] = quantile * maps.error[v];
  }
  return width;
}

}  // namespace explica::statistics
