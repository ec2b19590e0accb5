// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"
#include "Explica/Planar/PolygonVisibility.h"

namespace explica::planar {

/// What is truly seen of a region from a viewpoint.
struct VisiblePart {
  double fraction = 0;        ///< length of the region that is seen, front side, over its length
  double realVisibility = 0;  ///< flux that arrives over the region's length, in [0, 1]: the seen
                              ///< share times its cosine, the "real" average visibility of [Thesis,
                              ///< figure 4.14], with a flux of zero where nothing is seen
  Eigen::VectorXd edgeSeen;   ///< seen share of each region edge, in [0, 1], in the region's order
};

/// Seen share of a region by an exact angular sweep: edges enter and leave in the order of the
/// angles of their ends, and between two consecutive angles the nearest edge is the seen one.  The
/// rest of the curve hides too.  An edge counts as seen where its outer side (the right of its
/// direction) faces the viewpoint.
///
/// Edges must not cross (intersectingEdges); where they do, the middle of each interval decides.
/// Of several viewpoints the weighted mean.
/// O(n log n + n k) a viewpoint, k edges over one another at most.
/// @throws InvalidInput  empty region, or a viewpoint on the curve
[[nodiscard]] VisiblePart visiblePart(const Curve& curve, const Region& region,
                                      const Viewpoints& view);

}  // namespace explica::planar
