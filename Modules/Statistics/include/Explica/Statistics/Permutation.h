// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Statistics/Contrast.h"
#include "Explica/Statistics/Shuffler.h"
#include "Explica/Statistics/Tfce.h"

#include <Eigen/Core>

#include <vector>

namespace explica::statistics {

/// The surface that places are vertices of, as clusters need it.
struct PlaceGraph {
  geometry::IndexLists neighbours;
  std::vector<float> areas;  ///< V, mm^2
};

struct PermutationOptions {
  std::int64_t count = 10000;  ///< beside the data as they are; 0: none are made
  std::uint64_t seed = 1;
  Exchange exchange = Exchange::Auto;
  std::vector<int> blocks;      ///< N, or empty
  double clusterThreshold = 0;  ///< of |t| or F, > 0; clusters are found if there is a graph
  bool tfce = false;            ///< if there is a graph
};

/// Maxima over all places of each shuffle, the data as they are first, and the maps of those.
struct PermutationResult {
  std::vector<float> statistic;  ///< largest |t| or F
  std::vector<float> extent;     ///< of clusters; empty without a graph
  std::vector<float> mass;
  std::vector<float> tfce;             ///< empty unless asked for
  Eigen::VectorXd observed;            ///< V, t or F; 0 at places left out
  Eigen::VectorXd enhanced;            ///< V, its TFCE; empty unless asked for
  Exchange exchange = Exchange::Auto;  ///< what Auto came to
  bool exhaustive = false;             ///< every possible shuffle was made
  bool interrupted = false;            ///< fewer than asked for, perhaps none
};

/// The null distribution of a contrast's largest statistic by shuffling the residuals of the model
/// without its effect [FreedmanLane1983, Winkler2014].
///
/// With Q_x an orthonormal basis of the contrast's regressors and Q_z of the rest of the model's,
/// each shuffle P needs only Q_x^T P R_z Y and Q_z^T P R_z Y, as |P R_z Y| is known: shuffles are
/// multiplied in blocks, in single precision.  Directions of Q_z that no shuffle changes cost
/// nothing.  The same bytes with any number of threads.  A place where somebody has no value, or
/// all have the same, is left out.
/// @param values  N x V
/// @param graph   null: no clusters and no TFCE
/// @throws InvalidInput  an exchange that leaves the tested regressors as they are
[[nodiscard]] PermutationResult permute(const Design& design, const Contrast& contrast,
                                        const Eigen::MatrixXd& values, const PlaceGraph* graph,
                                        const PermutationOptions& options,
                                        const Monitor& monitor = {});

/// Family-wise P of a value: the share of maxima that reach it, the data's own included, up to the
/// round-off of single precision.
[[nodiscard]] double familyWiseP(const std::vector<float>& maxima, double value);
/// Of each |value|; NaN where it is 0.
[[nodiscard]] Eigen::VectorXd familyWiseP(const std::vector<float>& maxima,
                                          const Eigen::VectorXd& values);

}  // namespace explica::statistics
