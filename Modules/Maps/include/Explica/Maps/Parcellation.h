// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Maps/Resampling.h"

#include <vector>

namespace explica::maps {

/// A labelled surface by its sphere in register with others: a template's, or a person's.
struct LabelledSphere {
  TriangleMesh sphere;
  VertexKeys keys;          ///< V
  Eigen::VectorXd folding;  ///< V, sulcal depth; empty: not known
};

/// Labels, and how sure they are.
struct Parcellation {
  VertexKeys keys;        ///< V
  Eigen::VectorXd doubt;  ///< V, share of the votes against the key: 0 within regions, more at
                          ///< borders and where labelled people disagree
};

inline void describe(Results& t, const Parcellation& p) {
  t.count("vertices", "Vertices", "", p.keys.size());
  t.number("doubt_mean", "Mean doubt of the regions", "share",
           "Share of the votes against a vertex's region, over the vertices.",
           p.doubt.size() > 0 ? p.doubt.mean() : 0);
}

/// Labels of a surface by the votes of labelled ones in register with it.
///
/// Each of them votes at every vertex by its adaptive weights (resamplingWeights, the spheres' own
/// areas).  Of several whose folding is known, as is the surface's, the votes count by the inverse
/// of the mean squared difference of both foldings (mean 0, variance 1) around the vertex: the
/// maximum-likelihood weights of independent errors of that variance.  Of equal votes the smaller
/// key wins.
///
/// @param folding  V of `sphere`, or empty
/// @throws InvalidInput  as resamplingWeights; no atlas; keys or folding of other length
[[nodiscard]] Parcellation parcellate(const TriangleMesh& sphere, const Eigen::VectorXd& folding,
                                      const std::vector<LabelledSphere>& atlases);

}  // namespace explica::maps
