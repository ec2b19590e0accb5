// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Statistics/Clusters.h"
#include "Explica/Statistics/Permutation.h"
#include "Explica/Statistics/PlaceModel.h"
#include "Explica/Statistics/RandomField.h"

#include <Eigen/Core>

#include <vector>

namespace explica::statistics {

/// A surface whose vertices are the places.
struct PlaceSurface {
  TriangleMesh mesh;
  geometry::MeshTopology topology;
  Eigen::VectorXd areas;  ///< V, mm^2
  PlaceGraph graph;
};
[[nodiscard]] PlaceSurface placeSurface(const TriangleMesh& mesh);

struct InferenceOptions {
  double clusterP = 0.001;          ///< two-sided P of the threshold that forms clusters
  PermutationOptions permutations;  ///< but for their threshold
};

/// A cluster with all that was inferred of it; NaN where nothing was.
struct FoundCluster {
  Cluster cluster;
  bool negative = false;      ///< of t below the threshold's negative
  double statistic = 0;       ///< at the peak, with its sign
  double fieldPeak = kNaN;    ///< family-wise P by random field theory, of the peak
  double fieldExtent = kNaN;  ///< and of the extent in resels
  double peak = kNaN;         ///< family-wise P by permutation, of the peak
  double extent = kNaN;
  double mass = kNaN;
};

/// What of one contrast is real, at V places; P is two-sided for t.
struct Inference {
  Eigen::VectorXd q;           ///< false discovery rate
  Eigen::VectorXd field;       ///< family-wise P by random field theory; empty without a surface
  Eigen::VectorXd familyWise;  ///< by permutation; empty without
  Eigen::VectorXd enhanced;    ///< TFCE; empty unless asked for
  Eigen::VectorXd enhancedP;   ///< its family-wise P by permutation
  double threshold = 0;        ///< of |t| or F, that forms clusters
  std::vector<FoundCluster> clusters;  ///< largest first
  std::int64_t shuffles = 0;           ///< made, with the data as they are
  Exchange exchange = Exchange::Auto;
  bool interrupted = false;
};

/// Smoothness of the residuals as random field theory needs it.
struct Smoothness {
  Resels resels;
  double fwhm = 0;  ///< mm, sqrt(area / resels)
};
[[nodiscard]] Smoothness smoothnessOf(const PlaceSurface& surface,
                                      const Eigen::VectorXd& roughness);

/// @param values      N x V; empty: no permutations
/// @param surface     null: places without neighbours
/// @param smoothness  null: no random field theory
[[nodiscard]] Inference infer(const Design& design, const Contrast& contrast,
                              const ContrastMaps& maps, const Eigen::MatrixXd& values,
                              const PlaceSurface* surface, const Smoothness* smoothness,
                              const InferenceOptions& options, const Monitor& monitor = {});

}  // namespace explica::statistics
