// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Inference.h"

#include "Explica/Core/Types.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Statistics/Distributions.h"
#include "Explica/Statistics/FalseDiscovery.h"

#include <algorithm>
#include <cmath>

namespace explica::statistics {
namespace {

/// Degrees of freedom that most places have: those of all people.
double largestDf(const ContrastMaps& maps) {
  double df = 0;
  for (const double v : maps.df) df = std::fmax(df, v);
  return df;
}

void makePermutations(const Design& design, const Contrast& contrast, const Eigen::MatrixXd& values,
                      const PlaceSurface* surface, const PermutationOptions& asked,
                      const Monitor& monitor, Inference& inference, PermutationResult& result) {
  PermutationOptions options = asked;
  options.clusterThreshold = inference.threshold;
  result = permute(design, contrast, values, surface == nullptr ? nullptr : &surface->graph,
                   options, monitor);
  inference.shuffles = static_cast<std::int64_t>(result.statistic.size());
  inference.exchange = result.exchange;
  inference.interrupted = result.interrupted;
  if (result.statistic.empty()) return;
  inference.familyWise = familyWiseP(result.statistic, result.observed);
  if (result.tfce.empty()) return;
  inference.enhanced = result.enhanced;
  inference.enhancedP = familyWiseP(result.tfce, result.enhanced);
}

/// Degrees of freedom of F's numerator; 0 of t.
double numeratorDf(const Contrast& contrast) {
  return contrast.isT() ? 0 : static_cast<double>(contrast.weights.cols());
}

/// Clusters of both signs with their P.
void findAllClusters(const ContrastMaps& maps, const Contrast& contrast,
                     const PlaceSurface& surface, const Smoothness* smoothness, double df,
                     const PermutationResult& permutation, Inference& inference) {
  Eigen::VectorXd resels;
  std::optional<ClusterSizes> sizes;
  if (smoothness != nullptr) {
    resels = smoothness->resels.perVertex;
    sizes.emplace(inference.threshold, FieldKind{df, numeratorDf(contrast)},
                  (contrast.isT() ? 2 : 1) * smoothness->resels.byDimension[2], df);
  }
  for (const bool negative : {false, true}) {
    if (negative && !contrast.isT()) continue;
    const Eigen::VectorXd side = negative ? Eigen::VectorXd(-maps.statistic) : maps.statistic;
    for (const Cluster& c : findClusters(surface.topology.vertexVertices, side, inference.threshold,
                                         surface.areas, resels)) {
      FoundCluster found{c, negative, maps.statistic[c.peak]};
      if (inference.field.size() > 0) found.fieldPeak = inference.field[c.peak];
      if (sizes) found.fieldExtent = sizes->largest(c.weight);
      if (!permutation.extent.empty()) {
        found.peak = inference.familyWise[c.peak];
        found.extent = familyWiseP(permutation.extent, c.extent);
        found.mass = familyWiseP(permutation.mass, c.mass);
      }
      inference.clusters.push_back(std::move(found));
    }
  }
  std::ranges::stable_sort(inference.clusters, std::ranges::greater{},
                           [](const FoundCluster& found) { return found.cluster.extent; });
}

/// Two-sided P doubles that of one side; F has one side.
Eigen::VectorXd fieldP(const ContrastMaps& maps, const Contrast& contrast,
                       const Smoothness& smoothness) {
  Eigen::VectorXd p = Eigen::VectorXd::Constant(maps.statistic.size(), kNaN);
  for (Eigen::Index v = 0; v < p.size(); ++v) {
    const double height = contrast.isT() ? std::abs(maps.statistic[v]) : maps.statistic[v];
    if (std::isnan(height)) continue;
    p[v] = peakProbability(height, {maps.df[v], numeratorDf(contrast)}, smoothness.resels);
    if (contrast.isT()) p[v] = std::min(2 * p[v], 1.0);
  }
  return p;
}

}  // namespace

PlaceSurface placeSurface(const TriangleMesh& mesh) {
  PlaceSurface surface;
  surface.mesh = mesh;
  surface.topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  surface.areas = geometry::vertexAreas(mesh);
  surface.graph.neighbours = surface.topology.vertexVertices;
  for (const double area : surface.areas) surface.graph.areas.push_back(static_cast<float>(area));
  return surface;
}

Smoothness smoothnessOf(const PlaceSurface& surface, const Eigen::VectorXd& roughness) {
  std::vector<bool> known(static_cast<std::size_t>(surface.mesh.vertexCount()), true);
  for (Eigen::Index e = 0; e < roughness.size(); ++e) {
    if (!std::isnan(roughness[e])) continue;
    // Of an edge without roughness one end at least has no residuals; which, its other edges tell.
    known[surface.topology.edges(e, 0)] = false;
    known[surface.topology.edges(e, 1)] = false;
  }
  for (Eigen::Index e = 0; e < roughness.size(); ++e) {
    if (std::isnan(roughness[e])) continue;
    known[surface.topology.edges(e, 0)] = true;
    known[surface.topology.edges(e, 1)] = true;
  }
  Smoothness smoothness;
  smoothness.resels = reselsOf(surface.mesh.faces, surface.topology, roughness, known);
  double area = 0;
  for (Eigen::Index f = 0; f < surface.mesh.faceCount(); ++f) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && known[surface.mesh.faces(f, k)];
    if (!inside) continue;
    const Vector a = surface.mesh.corner(f, 1) - surface.mesh.corner(f, 0);
    area += a.cross(surface.mesh.corner(f, 2) - surface.mesh.corner(f, 0)).norm() / 2;
  }
  smoothness.fwhm = std::sqrt(area / smoothness.resels.byDimension[2]);
  return smoothness;
}

Inference infer(const Design& design, const Contrast& contrast, const ContrastMaps& maps,
                const Eigen::MatrixXd& values, const PlaceSurface* surface,
                const Smoothness* smoothness, const InferenceOptions& options,
                const Monitor& monitor) {
  Inference inference;
  inference.q = falseDiscoveryRate(maps.p);
  const double df = largestDf(maps);
  inference.threshold = contrast.isT() ? tQuantile(options.clusterP / 2, df)
                                       : fQuantile(options.clusterP, numeratorDf(contrast), df);
  if (smoothness != nullptr) inference.field = fieldP(maps, contrast, *smoothness);
  PermutationResult permutation;
  if (options.permutations.count > 0 && values.size() > 0) {
    makePermutations(design, contrast, values, surface, options.permutations, monitor, inference,
                     permutation);
  }
  if (surface != nullptr && df > 0) {
    findAllClusters(maps, contrast, *surface, smoothness, df, permutation, inference);
  }
  return inference;
}

}  // namespace explica::statistics
