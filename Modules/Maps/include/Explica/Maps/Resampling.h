// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"

#include <Eigen/SparseCore>

#include <array>
#include <string_view>

namespace explica::maps {

enum class ResamplingMethod {
  Adaptive,     ///< adaptive barycentric weights by area: every source vertex counts
  Barycentric,  ///< linear within the source's faces
  Nearest       ///< the corner of the largest barycentric weight
};
constexpr auto enumWords(ResamplingMethod) {
  using enum ResamplingMethod;
  return std::to_array<EnumWord<ResamplingMethod>>(
      {{Adaptive, "adaptive"}, {Barycentric, "barycentric"}, {Nearest, "nearest"}});
}

/// Weights W, target vertices x source vertices: rows that sum to 1, ascending columns.
using ResamplingWeights = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// @throws InvalidInput  vertices of very different distances from the origin; starts with `name`
void requireSphere(const TriangleMesh& mesh, std::string_view name);

/// Weights between two spheres in register, whatever their radii.
///
/// Barycentric weights are those of the nearest point of the other sphere's faces.  The adaptive
/// ones are Connectome Workbench's ADAP_BARY_AREA: a target vertex takes its own weights of source
/// vertices unless a source vertex beyond these has it as a corner; then it takes the weights that
/// source vertices give it.  Each weight is multiplied by the target's area and the column scaled
/// to the source's, so that every source vertex hands on its area; then rows are scaled to 1.
///
/// @param fromAreas, toAreas  one a vertex, mm^2; for Adaptive, usually of middle surfaces
/// @throws InvalidInput  as requireSphere, or areas of other length
[[nodiscard]] ResamplingWeights resamplingWeights(const TriangleMesh& from, const TriangleMesh& to,
                                                  ResamplingMethod method,
                                                  const Eigen::VectorXd& fromAreas,
                                                  const Eigen::VectorXd& toAreas);

/// W times each column of `values`; NaN is left out while at least half of the weight is known,
/// else the result is NaN.
[[nodiscard]] Eigen::MatrixXd resampleMaps(const ResamplingWeights& weights,
                                           const Eigen::MatrixXd& values);

/// Amounts at source vertices (areas, volumes), each shared among the target's vertices in
/// proportion to weight times area, so that sums stay; of a vertex that no target takes from
/// nothing is left, which Adaptive weights do not have.  NaN counts as 0.
/// @param toAreas  mm^2, as given to resamplingWeights()
[[nodiscard]] Eigen::VectorXd resampleAmounts(const ResamplingWeights& weights,
                                              const Eigen::VectorXd& toAreas,
                                              const Eigen::VectorXd& amounts);

using VertexKeys = Eigen::Matrix<Label, Eigen::Dynamic, 1>;  ///< V

/// The key of the largest weight at each target vertex; of equal ones the smallest key.
[[nodiscard]] VertexKeys resampleLabels(const ResamplingWeights& weights, const VertexKeys& keys);

/// Values of a surface's map at its points nearest to others, such as vertices of a surface that
/// lies almost in the same place: linear within faces.
/// @param values    V; NaN: not known
/// @param points    P x 3, in the surface's space, mm
/// @param farthest  mm
/// @return P; NaN where the nearest point is farther away, or has a corner that is not known
[[nodiscard]] Eigen::VectorXd mapNear(const TriangleMesh& surface, const Eigen::VectorXd& values,
                                      const Positions& points, double farthest);

}  // namespace explica::maps
