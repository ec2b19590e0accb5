// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/PlaceModel.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Types.h"
#include "Explica/Statistics/Distributions.h"
#include "RandomIntercept.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <cmath>

namespace explica::statistics {
namespace {

/// One place's fit.
struct PlaceFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd inverse;  // p x p, covariance of the coefficients over `variance`
  double variance = kNaN;
  double ratio = 0;
};

/// People of a place with a value, and which columns of theirs vary within groups.
struct Rows {
  Eigen::MatrixXd design;
  std::vector<int> groups;  // numbered from 0 without gaps, or empty
  int groupCount = 0;
  std::vector<bool> within;
};

std::vector<bool> variesWithin(const Eigen::MatrixXd& design, const std::vector<int>& groups,
                               int count) {
  std::vector<bool> varies(static_cast<std::size_t>(design.cols()), false);
  for (Eigen::Index c = 0; c < design.cols(); ++c) {
    std::vector<double> first(static_cast<std::size_t>(count), kNaN);
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      double& known = first[static_cast<std::size_t>(groups[static_cast<std::size_t>(i)])];
      if (std::isnan(known)) known = design(i, c);
      if (known != design(i, c)) varies[static_cast<std::size_t>(c)] = true;
    }
  }
  return varies;
}

Rows rowsOf(const Eigen::MatrixXd& design, const std::vector<int>& groups,
            const std::vector<Eigen::Index>& people) {
  Rows rows;
  rows.design.resize(static_cast<Eigen::Index>(people.size()), design.cols());
  std::vector<int> number(groups.size(), -1);
  for (std::size_t i = 0; i < people.size(); ++i) {
    rows.design.row(static_cast<Eigen::Index>(i)) = design.row(people[i]);
    if (groups.empty()) continue;
    int& known = number[static_cast<std::size_t>(groups[static_cast<std::size_t>(people[i])])];
    if (known < 0) known = rows.groupCount++;
    rows.groups.push_back(known);
  }
  if (!groups.empty()) rows.within = variesWithin(rows.design, rows.groups, rows.groupCount);
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
    if (!rows.within[static_cast<std::size_t>(c)]) continue;
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
  PlaceFit fit;
  if (!rows.groups.empty()) {
    const RandomInterceptFit mixed = fitRandomIntercept(rows.design, y, rows.groups);
    return {mixed.coefficients, mixed.inverse, mixed.variance, mixed.ratio};
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows.design);
  fit.coefficients = qr.solve(y);
  fit.variance = (y - rows.design * fit.coefficients).squaredNorm() /
                 static_cast<double>(rows.design.rows() - rows.design.cols());
  const Eigen::Index p = rows.design.cols();
  const Eigen::MatrixXd inverse =
      qr.matrixQR().topLeftCorner(p, p).triangularView<Eigen::Upper>().solve(
          Eigen::MatrixXd::Identity(p, p));
  fit.inverse = inverse * inverse.transpose();
  return fit;
}

}  // namespace

ModelMaps::ModelMaps(Eigen::Index columns, Eigen::Index places, std::size_t contrastCount)
    : coefficients(Eigen::MatrixXd::Constant(columns, places, kNaN)),
      variance(Eigen::VectorXd::Constant(places, kNaN)),
      ratio(variance),
      people(Eigen::VectorXi::Zero(places)),
      contrasts(contrastCount, ContrastMaps{variance, variance, variance, variance, variance}) {}

struct PlaceModel::Implementation {
  Eigen::MatrixXd design;
  std::vector<int> groups;
  std::vector<Contrast> contrasts;
  Rows all;                 // of everybody
  Eigen::MatrixXd inverse;  // (X^T X)^-1
  Eigen::MatrixXd solver;   // p x N, (X^T X)^-1 X^T

  void fitIncomplete(const Eigen::VectorXd& y, const std::vector<Eigen::Index>& people,
                     Eigen::Index v, ModelMaps& maps) const {
    if (static_cast<Eigen::Index>(people.size()) <= design.cols()) return;
    const Rows rows = rowsOf(design, groups, people);
    if (rows.design.colPivHouseholderQr().rank() < rows.design.cols()) return;
    Eigen::VectorXd values(rows.design.rows());
    for (std::size_t i = 0; i < people.size(); ++i) {
      values[static_cast<Eigen::Index>(i)] = y[people[i]];
    }
    write(solve(rows, values), rows, v, maps);
  }

  void fitComplete(const Eigen::VectorXd& y, Eigen::Index v, ModelMaps& maps) const {
    if (!groups.empty()) {
      write(solve(all, y), all, v, maps);
      return;
    }
    PlaceFit fit;
    fit.coefficients = solver * y;
    // A second round takes off what rounding left in the span of the design.
    fit.coefficients += solver * (y - design * fit.coefficients);
    fit.variance = (y - design * fit.coefficients).squaredNorm() /
                   static_cast<double>(design.rows() - design.cols());
    fit.inverse = inverse;
    write(fit, all, v, maps);
  }

  void write(const PlaceFit& fit, const Rows& rows, Eigen::Index v, ModelMaps& maps) const {
    maps.coefficients.col(v) = fit.coefficients;
    maps.variance[v] = fit.variance;
    maps.ratio[v] = fit.ratio;
    for (std::size_t k = 0; k < contrasts.size(); ++k) {
      evaluate(contrasts[k], fit, dfOf(contrasts[k], rows), v, maps.contrasts[k]);
    }
  }
};

PlaceModel::PlaceModel(const Design& design, std::vector<Contrast> contrasts)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& m = *implementation_;
  m.design = design.matrix;
  m.groups = design.groups;
  m.contrasts = std::move(contrasts);
  std::vector<Eigen::Index> everybody(static_cast<std::size_t>(design.people()));
  for (std::size_t i = 0; i < everybody.size(); ++i) everybody[i] = static_cast<Eigen::Index>(i);
  m.all = rowsOf(m.design, m.groups, everybody);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(m.design);
  const Eigen::Index p = m.design.cols();
  const Eigen::MatrixXd upper =
      qr.matrixQR().topLeftCorner(p, p).triangularView<Eigen::Upper>().solve(
          Eigen::MatrixXd::Identity(p, p));
  m.inverse = upper * upper.transpose();
  m.solver = m.inverse * m.design.transpose();
}

PlaceModel::~PlaceModel() = default;

void PlaceModel::fit(const Eigen::MatrixXd& values, Eigen::Index first, ModelMaps& maps) const {
  parallelFor(static_cast<std::size_t>(values.cols()), 64, [&](std::size_t b) {
    const Eigen::VectorXd y = values.col(static_cast<Eigen::Index>(b));
    std::vector<Eigen::Index> people;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      if (std::isfinite(y[i])) people.push_back(i);
    }
    const Eigen::Index v = first + static_cast<Eigen::Index>(b);
    maps.people[v] = static_cast<int>(people.size());
    if (maps.people[v] == y.size())
      implementation_->fitComplete(y, v, maps);
    else
      implementation_->fitIncomplete(y, people, v, maps);
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
