// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

/// Vectorised tests of how near pairs are, for the machine's widest vectors, chosen at run time.
///
/// Without fused multiply-add, and each lane for itself: the same bits on every processor.
namespace explica::collision::kernels {

/// Eight pairs of features, relative to the first point of each and to its motion.
struct alignas(64) PairBatch {
  static constexpr int kLanes = 8;
  double at[3][3][kLanes];      ///< points 1, 2, 3 [point][axis][pair], mm
  double motion[3][3][kLanes];  ///< theirs
  double separation[kLanes];    ///< out: lower bound of the distance along the joining line, mm
  double closing[kLanes];       ///< out: how much of it the motion may take, mm; negative: opens
};

/// Of a vertex (point 0) and a face, along the line that joins their nearest points; NaN where they
/// touch.
void separateVertexFace(PairBatch& batch);

/// Of two edges (points 0, 1 and 2, 3).
void separateEdgeEdge(PairBatch& batch);

}  // namespace explica::collision::kernels
