// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Smoothing.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Maps/HeatFlow.h"

#include <cmath>
#include <numbers>
#include <optional>

namespace explica::maps {
namespace {

constexpr int kSteps = 8;  // amplitude error of every wave below 1e-3, width below 1e-3

/// Where maps from `first` to `last` are known, within the mask.
std::vector<bool> knownWithin(const Eigen::MatrixXd& values, const std::vector<bool>& mask) {
  std::vector<bool> known(static_cast<std::size_t>(values.rows()));
  for (std::size_t v = 0; v < known.size(); ++v) {
    known[v] = (mask.empty() || mask[v]) && values.row(static_cast<Eigen::Index>(v)).allFinite();
  }
  return known;
}

void requireSizes(const TriangleMesh& mesh, const Eigen::MatrixXd& values,
                  const std::vector<bool>& mask) {
  if (values.rows() != mesh.vertexCount() ||
      (!mask.empty() && mask.size() != static_cast<std::size_t>(mesh.vertexCount()))) {
    throw InvalidInput("maps and mask need one value for each of the surface's " +
                       std::to_string(mesh.vertexCount()) + " vertices");
  }
}

}  // namespace

Eigen::MatrixXd smoothMaps(const TriangleMesh& mesh, Eigen::MatrixXd values, double fwhm,
                           const std::vector<bool>& mask, const Monitor& monitor) {
  requireSizes(mesh, values, mask);
  if (!(fwhm > 0)) throw InvalidInput("the width to smooth by is not above 0");
  const double time = fwhm * fwhm / (16 * std::numbers::ln2);
  // Neighbouring columns that are known at the same vertices share a factorisation.
  for (Eigen::Index first = 0, last = 0; first < values.cols(); first = last) {
    const std::vector<bool> known = knownWithin(values.col(first), mask);
    do {
      ++last;
    } while (last < values.cols() && knownWithin(values.col(last), mask) == known);
    Eigen::MatrixXd block = values.middleCols(first, last - first);
    for (std::size_t v = 0; v < known.size(); ++v) {
      if (!known[v]) block.row(static_cast<Eigen::Index>(v)).setZero();
    }
    const HeatFlow flow(mesh, time / kSteps, known);
    for (int step = 0; step < kSteps && !monitor.shouldStop(); ++step) {
      monitor.progress(
          (static_cast<double>(first) + static_cast<double>((last - first) * step) / kSteps) /
              static_cast<double>(values.cols()),
          "smoothing");
      flow.advance(block);
    }
    for (std::size_t v = 0; v < known.size(); ++v) {
      const auto row = static_cast<Eigen::Index>(v);
      if (known[v]) values.row(row).segment(first, last - first) = block.row(row);
    }
  }
  return values;
}

double estimateFwhm(const TriangleMesh& mesh, const Eigen::MatrixXd& values,
                    const std::vector<bool>& mask) {
  requireSizes(mesh, values, mask);
  const std::vector<bool> known = knownWithin(values, mask);
  const geometry::MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  double mean = 0, count = 0;
  for (Eigen::Index v = 0; v < values.rows(); ++v) {
    if (known[v]) mean += values(v, 0), ++count;
  }
  mean /= count;
  const auto residual = [&](Eigen::Index v) -> Eigen::RowVectorXd {
    return values.row(v).array() - (values.cols() == 1 ? mean : values.row(v).mean());
  };
  double variance = 0, difference = 0;
  std::vector<double> squaredLengths;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    const std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
    if (!known[a] || !known[b]) continue;
    const Eigen::RowVectorXd x = residual(a), y = residual(b);
    variance += 0.5 * (x.squaredNorm() + y.squaredNorm());
    difference += 0.5 * (x - y).squaredNorm();
    squaredLengths.push_back((mesh.positions.row(a) - mesh.positions.row(b)).squaredNorm());
  }
  if (!(variance > 0)) return kNaN;
  // Decorrelation of all edges, 1 - rho, falls with the width: bisection in its logarithm.
  const double wanted = difference / variance * static_cast<double>(squaredLengths.size());
  const auto decorrelation = [&](double fwhm) {
    double sum = 0;
    for (const double d : squaredLengths) {
      sum -= std::expm1(-2 * std::numbers::ln2 * d / (fwhm * fwhm));
    }
    return sum;
  };
  double low = 1e-3, high = 1e3;
  const double edge = std::sqrt(squaredLengths.empty() ? 1 : squaredLengths.front());
  if (wanted >= decorrelation(low * edge)) return 0;
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = std::sqrt(low * high);
    (decorrelation(middle * edge) > wanted ? low : high) = middle;
  }
  return low * edge;
}

}  // namespace explica::maps
