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
  for (const double v : maps.df) {
    if (v > df) df = v;
  }
  return df;
}

/// Two-sided P doubles that of one side; F has one side.
double ofBothSides(double p, const Contrast& contrast) {
  return contrast.isT() ? std::min(2 * p, 1.0) : p;
}

void makePermutations(const Design& design, const Contrast& contrast, const Eigen::MatrixXd& values,
                      const PlaceSurface* surface, const InferenceOptions& options,
                      const Monitor& monitor, Inference& inference, PermutationResult& result) {
  PermutationOptions permutation;
  permutation.count = options.permutations;
  permutation.seed = options.seed;
  permutation.exchange = options.exchange;
  permutation.blocks = options.blocks;
  permutation.clusterThreshold = inference.threshold;
  permutation.tfce = options.tfce && surface != nullptr;
  result = permute(design, contrast, values, surface == nullptr ? nullptr : &surface->graph,
                   permutation, monitor);
  inference.shuffles = static_cast<std::int64_t>(result.statistic.size());
  inference.exchange = result.exchange;
  inference.exhaustive = result.exhaustive;
  inference.interrupted = result.interrupted;
  if (result.statistic.empty()) return;
  inference.familyWise = familyWiseP(result.statistic, result.observed);
  if (permutation.tfce) {
    inference.enhanced = result.enhanced;
    inference.enhancedP = familyWiseP(result.tfce, result.enhanced);
  }
}

/// Clusters of one sign with their P.
class ClusterJudge {
 public:
  ClusterJudge(const Contrast& contrast, const Inference& inference,
               const PermutationResult& permutation, const Smoothness* smoothness, double df)
      : inference_(inference), permutation_(permutation) {
    if (smoothness == nullptr) return;
    const FieldKind kind{df, contrast.isT() ? 0 : static_cast<double>(contrast.weights.cols())};
    const double sides = contrast.isT() ? 2 : 1;
    sizes_.emplace(inference.threshold, kind, sides * smoothness->resels.byDimension[2], df);
  }

  FoundCluster judge(const Cluster& cluster, bool negative, double statistic) const {
    FoundCluster found{cluster, negative, statistic, kNaN, kNaN, kNaN, kNaN, kNaN};
    if (inference_.field.size() > 0) found.fieldPeak = inference_.field[cluster.peak];
    if (sizes_) found.fieldExtent = sizes_->largest(cluster.weight);
    if (permutation_.extent.empty()) return found;
    found.peak = inference_.familyWise[cluster.peak];
    found.extent = familyWiseP(permutation_.extent, cluster.extent);
    found.mass = familyWiseP(permutation_.mass, cluster.mass);
    return found;
  }

 private:
  const Inference& inference_;
  const PermutationResult& permutation_;
  std::optional<ClusterSizes> sizes_;
};

void findAllClusters(const ContrastMaps& maps, const Contrast& contrast,
                     const PlaceSurface& surface, const Smoothness* smoothness,
                     const ClusterJudge& judge, Inference& inference) {
  const Eigen::VectorXd weights =
      smoothness == nullptr ? Eigen::VectorXd() : smoothness->resels.perVertex;
  for (const bool negative : {false, true}) {
    if (negative && !contrast.isT()) continue;
    const Eigen::VectorXd side = negative ? Eigen::VectorXd(-maps.statistic) : maps.statistic;
    for (const Cluster& c : findClusters(surface.topology.vertexVertices, side, inference.threshold,
                                         surface.areas, weights)) {
      inference.clusters.push_back(judge.judge(c, negative, maps.statistic[c.peak]));
    }
  }
  std::stable_sort(inference.clusters.begin(), inference.clusters.end(),
                   [](const FoundCluster& a, const FoundCluster& b) {
                     return a.cluster.extent > b.cluster.extent;
                   });
}

Eigen::VectorXd fieldP(const ContrastMaps& maps, const Contrast& contrast,
                       const Smoothness& smoothness) {
  Eigen::VectorXd p(maps.statistic.size());
  const double df1 = contrast.isT() ? 0 : static_cast<double>(contrast.weights.cols());
  for (Eigen::Index v = 0; v < p.size(); ++v) {
    p[v] = std::isnan(maps.statistic[v])
               ? kNaN
               : ofBothSides(peakProbability(
                                 contrast.isT() ? std::abs(maps.statistic[v]) : maps.statistic[v],
                                 {maps.df[v], df1}, smoothness.resels),
                             contrast);
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
    known[static_cast<std::size_t>(surface.topology.edges(e, 0))] = false;
    known[static_cast<std::size_t>(surface.topology.edges(e, 1))] = false;
  }
  for (Eigen::Index e = 0; e < roughness.size(); ++e) {
    if (std::isnan(roughness[e])) continue;
    known[static_cast<std::size_t>(surface.topology.edges(e, 0))] = true;
    known[static_cast<std::size_t>(surface.topology.edges(e, 1))] = true;
  }
  Smoothness smoothness;
  smoothness.resels = reselsOf(surface.mesh.faces, surface.topology, roughness, known);
  double area = 0;
  for (Eigen::Index f = 0; f < surface.mesh.faceCount(); ++f) {
    bool inside = true;
    for (int k = 0; k < 3; ++k)
      inside = inside && known[static_cast<std::size_t>(surface.mesh.faces(f, k))];
    if (!inside) continue;
    const Vector a = surface.mesh.corner(f, 1) - surface.mesh.corner(f, 0);
    area += a.cross(surface.mesh.corner(f, 2) - surface.mesh.corner(f, 0)).norm() / 2;
  }
  smoothness.fwhm = std::sqrt(area / smoothness.resels.byDimension[2]);
  return smoothness;
}

Inference infer(const Design& design, const Contrast& contrast, const ContrastMaps& maps,
                const Eigen::MatrixXd* values, const PlaceSurface* surface,
                const Smoothness* smoothness, const InferenceOptions& options,
                const Monitor& monitor) {
  Inference inference;
  inference.q = falseDiscoveryRate(maps.p);
  const double df = largestDf(maps);
  inference.threshold =
      contrast.isT()
          ? tQuantile(options.clusterP / 2, df)
          : fQuantile(options.clusterP, static_cast<double>(contrast.weights.cols()), df);
  if (smoothness != nullptr) inference.field = fieldP(maps, contrast, *smoothness);
  PermutationResult permutation;
  if (options.permutations > 0 && values != nullptr) {
    makePermutations(design, contrast, *values, surface, options, monitor, inference, permutation);
  }
  if (surface != nullptr && df > 0) {
    const ClusterJudge judge(contrast, inference, permutation, smoothness, df);
    findAllClusters(maps, contrast, *surface, smoothness, judge, inference);
  }
  return inference;
}

}  // namespace explica::statistics
