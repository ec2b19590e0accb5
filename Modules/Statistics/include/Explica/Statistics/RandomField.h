// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/MeshTopology.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace explica::statistics {

/// Gives one person's values at all places; called from several threads at once.
using PersonReader = std::function<void(std::size_t person, std::span<double> values)>;

/// Roughness along each edge: the sum over people of (u_a - u_b)^2, u being the residuals of a
/// place over the root of their sum of squares [Worsley1999].  NaN at an edge with an end whose
/// coefficients are NaN or where somebody has no value.  Reads each person once.
/// @param design        N x p
/// @param coefficients  p x V
[[nodiscard]] Eigen::VectorXd edgeRoughness(const Eigen::MatrixXd& design,
                                            const Eigen::MatrixXd& coefficients, const Edges& edges,
                                            const PersonReader& reader);

/// How many resolution elements a smooth field has on a surface, by dimension.
struct Resels {
  std::array<double, 3> byDimension = {0, 0, 0};  ///< Euler characteristic, half length, area
  Eigen::VectorXd perVertex;                      ///< V, of dimension two
  double places = 0;                              ///< vertices counted
};

/// Lipschitz-Killing curvatures of the surface in the metric that the roughness defines, over
/// (4 log 2)^(d/2) [TaylorWorsley2007].
/// @param roughness  E, along topology.edges; vertices of an edge without it are outside
/// @param mask       V, of the vertices to count
[[nodiscard]] Resels reselsOf(const Faces& faces, const geometry::MeshTopology& topology,
                              const Eigen::VectorXd& roughness, const std::vector<bool>& mask);

/// A field of t, or of F where `df1` is more than 0.
struct FieldKind {
  double df = 0;   ///< of the residuals; may be infinite
  double df1 = 0;  ///< of the numerator; 0: a field of t
};

/// Euler characteristic densities per resel in zero, one and two dimensions [Worsley1996, Table
/// II].
[[nodiscard]] std::array<double, 3> eulerDensities(double threshold, const FieldKind& kind);

/// P that the field's maximum exceeds `threshold` somewhere: the lesser of the expected Euler
/// characteristic and Bonferroni's bound, at most 1.
[[nodiscard]] double peakProbability(double threshold, const FieldKind& kind, const Resels& resels);

/// P of clusters by their size, as SurfStat has it: the number of clusters is Poisson's, the size
/// of one is that of a paraboloid at a peak, allowing for roughness that was itself estimated
/// [Cao1999, HayasakaNichols2004].
class ClusterSizes {
 public:
  /// @param threshold  that forms the clusters
  /// @param roughnessDf  degrees of freedom of the roughness; infinite: it is known
  ClusterSizes(double threshold, const FieldKind& kind, double resels, double roughnessDf);

  /// P that one cluster is larger than this many resels.
  [[nodiscard]] double single(double resels) const;
  /// P that the largest of all clusters is.
  [[nodiscard]] double largest(double resels) const;
  /// Expected number of clusters.
  [[nodiscard]] double expected() const { return expected_; }

 private:
  double expected_ = 0;
  double scale_ = 0;  // resels of a cluster whose logarithm is 0 in the table
  double first_ = 0, step_ = 0;
  std::vector<double> tail_;  // P that the logarithm of the size exceeds first_ + i step_; empty of
                              // a Gaussian field, which has a closed form
};

}  // namespace explica::statistics
