// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Resampling.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Sampling/Transfer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace explica::maps {
namespace {

constexpr double kEnough = 0.5;  // of the weight must be known

TriangleMesh onUnitSphere(const TriangleMesh& sphere, std::string_view name) {
  requireSphere(sphere, name);
  return {sphere.positions.rowwise().normalized(), sphere.faces};
}

/// Barycentric weights of each of `points` in the faces of `sphere`.
ResamplingWeights barycentric(const TriangleMesh& sphere, const TriangleMesh& points) {
  const sampling::NearestOnSurface nearest = sampling::nearestOn(sphere, points.positions);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(3 * points.vertexCount()));
  for (Eigen::Index p = 0; p < points.vertexCount(); ++p) {
    for (int k = 0; k < 3; ++k) {
      if (nearest.weights(p, k) > 0) {
        entries.emplace_back(p, nearest.corners(p, k), nearest.weights(p, k));
      }
    }
  }
  ResamplingWeights weights(points.vertexCount(), sphere.vertexCount());
  weights.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

using Row = ResamplingWeights::InnerIterator;

/// Whether every source vertex of row i of `given` is one of row i of `taken`.
bool covered(const ResamplingWeights& taken, const ResamplingWeights& given, Eigen::Index i) {
  Row own(taken, i);
  for (Row it(given, i); it; ++it) {
    while (own && own.index() < it.index()) ++own;
    if (!own || own.index() != it.index()) return false;
  }
  return true;
}

ResamplingWeights adaptive(const ResamplingWeights& taken, const ResamplingWeights& given,
                           const Eigen::VectorXd& fromAreas, const Eigen::VectorXd& toAreas) {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd handed = Eigen::VectorXd::Zero(fromAreas.size());
  for (Eigen::Index i = 0; i < taken.rows(); ++i) {
    for (Row it(covered(taken, given, i) ? taken : given, i); it; ++it) {
      entries.emplace_back(i, it.index(), it.value() * toAreas[i]);
      handed[it.index()] += it.value() * toAreas[i];
    }
  }
  ResamplingWeights weights(taken.rows(), taken.cols());
  weights.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd scale =
      (handed.array() > 0).select(fromAreas.array() / handed.array(), 0.0);
  return weights * scale.asDiagonal();
}

/// The largest entry of each row, of equal ones the first, as 1.
ResamplingWeights largestOnly(const ResamplingWeights& weights) {
  ResamplingWeights largest(weights.rows(), weights.cols());
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    Row best(weights, i);
    for (Row it(weights, i); it; ++it) {
      if (it.value() > best.value()) best = it;
    }
    largest.insert(i, best.index()) = 1;
  }
  return largest;
}

void scaleRows(ResamplingWeights& weights) {
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    const double sum = weights.row(i).sum();
    if (sum > 0) weights.row(i) /= sum;
  }
}

}  // namespace

void requireSphere(const TriangleMesh& mesh, std::string_view name) {
  constexpr double kRoundness = 0.5;  // least over largest distance; FreeSurfer's have 0.9999
  const Eigen::VectorXd radii = mesh.positions.rowwise().norm();
  if (radii.size() > 0 && radii.minCoeff() > kRoundness * radii.maxCoeff()) return;
  throw InvalidInput(std::string(name) + ": is no sphere about the origin (distances from it: " +
                     std::to_string(radii.size() > 0 ? radii.minCoeff() : 0) + " to " +
                     std::to_string(radii.size() > 0 ? radii.maxCoeff() : 0) + " mm)");
}

ResamplingWeights resamplingWeights(const TriangleMesh& from, const TriangleMesh& to,
                                    ResamplingMethod method, const Eigen::VectorXd& fromAreas,
                                    const Eigen::VectorXd& toAreas) {
  const TriangleMesh source = onUnitSphere(from, "sphere of the maps");
  const TriangleMesh target = onUnitSphere(to, "target sphere");
  const ResamplingWeights taken = barycentric(source, target);
  if (method == ResamplingMethod::Barycentric) return taken;
  if (method == ResamplingMethod::Nearest) return largestOnly(taken);
  if (fromAreas.size() != from.vertexCount() || toAreas.size() != to.vertexCount()) {
    throw InvalidInput("areas: one is needed for each vertex of both spheres");
  }
  ResamplingWeights weights =
      adaptive(taken, barycentric(target, source).transpose(), fromAreas, toAreas);
  scaleRows(weights);
  return weights;
}

Eigen::MatrixXd resampleMaps(const ResamplingWeights& weights, const Eigen::MatrixXd& values) {
  Eigen::MatrixXd result(weights.rows(), values.cols());
  parallelFor(static_cast<std::size_t>(weights.rows()), [&](std::size_t row) {
    const auto i = static_cast<Eigen::Index>(row);
    for (Eigen::Index map = 0; map < values.cols(); ++map) {
      double sum = 0, known = 0;
      for (Row it(weights, i); it; ++it) {
        const double value = values(it.index(), map);
        if (!std::isfinite(value)) continue;
        sum += it.value() * value;
        known += it.value();
      }
      result(i, map) = known >= kEnough ? sum / known : kNaN;
    }
  });
  return result;
}

Eigen::VectorXd resampleAmounts(const ResamplingWeights& weights, const Eigen::VectorXd& toAreas,
                                const Eigen::VectorXd& amounts) {
  Eigen::VectorXd handedOn = weights.transpose() * toAreas;
  for (Eigen::Index v = 0; v < handedOn.size(); ++v) {
    const bool known = handedOn[v] > 0 && std::isfinite(amounts[v]);
    handedOn[v] = known ? amounts[v] / handedOn[v] : 0;
  }
  return toAreas.cwiseProduct(weights * handedOn);
}

VertexKeys resampleLabels(const ResamplingWeights& weights, const VertexKeys& keys) {
  VertexKeys result(weights.rows());
  parallelFor(static_cast<std::size_t>(weights.rows()), [&](std::size_t row) {
    const auto i = static_cast<Eigen::Index>(row);
    std::map<Label, double> votes;
    for (Row it(weights, i); it; ++it) votes[keys[it.index()]] += it.value();
    const auto most = std::ranges::max_element(
        votes, [](const auto& a, const auto& b) { return a.second < b.second; });
    result[i] = most->first;
  });
  return result;
}

Eigen::VectorXd mapNear(const TriangleMesh& surface, const Eigen::VectorXd& values,
                        const Positions& points, double farthest) {
  const sampling::NearestOnSurface nearest = sampling::nearestOn(surface, points);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(points.rows(), kNaN);
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    if (nearest.distance[p] > farthest) continue;
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += nearest.weights(p, k) * values[nearest.corners(p, k)];
    result[p] = sum;
  }
  return result;
}

}  // namespace explica::maps
