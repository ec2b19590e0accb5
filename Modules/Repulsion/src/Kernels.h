// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// Vectorised sums of the multipole tree, for the machine's widest vectors, chosen at run time.
///
/// Single precision on coordinates relative to a nearby centre and in units of about one edge, so
/// that terms are right to about 1e-6; sums over many faces are added in double precision
/// elsewhere. phi(x) is the integral of 1/|x - y|^2 dS(y), g its gradient.
namespace explica::repulsion::kernels {

inline constexpr int kLanes = 16;  ///< faces of a leaf and pairs of a batch

/// Up to 16 target faces with three quadrature points each, and their sums.
struct alignas(64) TargetLeaf {
  float point[3][3][kLanes];  ///< [quadrature point][axis][face]
  float centroid[3][kLanes];
  float radius[kLanes];     ///< farthest corner from the centroid
  float phi[2][3][kLanes];  ///< [source set][quadrature point][face]
  float g[3][3][kLanes];    ///< [quadrature point][axis][face]
};

/// A source face with its quadrature points, relative to its group's centre.
struct alignas(64) SourceFace {
  float point[3][4];  ///< x, y, z, a third of the area
  float centroid[3];
  float radius;
};

/// Sources too near for their moments; `offset` is their group's centre seen from the target's.
struct CloseLeaf {
  const SourceFace* faces;
  std::int32_t count;
  std::int32_t first;  ///< number of its first face
  float offset[3];
  bool mayTouch;  ///< some face may be within `nearRatio` of a target
};

/// Sources seen as one: mass, centre seen from the target's, second moments.
struct FarNode {
  float centre[3];
  float mass;
  float xx, yy, zz, xy, xz, yz;
  float trace;
};

/// A source face too near for the quadrature of some targets, one bit each.
struct NearHit {
  std::int32_t face;
  std::uint32_t targets;
};

/// The points of a source face whose weight every target takes: x, y, z, weight.
struct alignas(16) ClearFace {
  float point[3][4];
};

/// The points of a source face whose weight some targets do not take.
struct alignas(64) MaskedFace {
  float weight[kLanes];
  float point[3][4];
};

/// Room for what addCloseLeaves() sorts its faces into, and one more, each.
struct CloseRoom {
  ClearFace* clear;
  MaskedFace* masked;
  NearHit* hits;
};

/// Adds what far nodes contribute, by monopole and quadrupole, at every quadrature point.
void addFarNodes(TargetLeaf& target, int set, const FarNode* nodes, std::size_t count);

/// The same for nodes many face sizes away: evaluated at the centroids and carried to the
/// quadrature points by the monopoles' second derivatives.
void addFarthestNodes(TargetLeaf& target, int set, const FarNode* nodes, std::size_t count);

/// Adds three by three quadrature points of every pair of faces whose centroids are at least
/// `nearRatio` sums of radii apart; lists the other pairs.
/// @return number of hits
std::size_t addCloseLeaves(TargetLeaf& target, int set, const CloseLeaf* leaves, std::size_t count,
                           float nearRatio, const CloseRoom& room);

/// Means of 1/|x - y|^2 over pairs of triangles and derivatives by the first one's corners.
struct alignas(64) ApartBatch {
  float s[9][kLanes];  ///< corner k, axis a at 3 k + a
  float t[9][kLanes];
  float value[kLanes];
  float byS[9][kLanes];
};
/// @param fine  twelve points a triangle instead of seven
void integrateApart(ApartBatch& batch, bool fine);

/// Rules of the reduced integrals over pairs with common corners, by how near the domain comes to
/// the singularity; beyond the last, use PairIntegral.h.
inline constexpr int kRules = 4;

/// Means over pairs with a common edge: 1/|z|^2 over the six triangles of PairIntegral.h, summed.
struct alignas(64) EdgeBatch {
  float arm[9][kLanes];  ///< e, a, b seen from corner 0
  float value[kLanes];
  float byArm[9][kLanes];
};
/// Number of the rule that each pair needs, kRules if none is fine enough.
void chooseEdgeRules(const EdgeBatch& batch, std::int32_t* rules);
void integrateEdge(EdgeBatch& batch, int rule);

/// Means over pairs with a common corner, summed: (edge of S) x T and S x (edge of T).
struct alignas(64) VertexBatch {
  float arm[12][kLanes];  ///< other corners of S and of T, seen from the common one
  float value[kLanes];
  float byArm[12][kLanes];
};
void chooseVertexRules(const VertexBatch& batch, std::int32_t* rules);
void integrateVertex(VertexBatch& batch, int rule);

/// The plain all-pairs sum that tree codes are compared with: sums of w_j / d^2 over all other
/// centroids, and their gradients.  Arrays of `count`, a multiple of 16.
template <class T>
struct CentroidSum {
  const T *x, *y, *z, *w;
  std::size_t count;
  T *phi, *gx, *gy, *gz;
};
void sumCentroids(const CentroidSum<float>& sum, std::size_t begin, std::size_t end);
void sumCentroids(const CentroidSum<double>& sum, std::size_t begin, std::size_t end);

/// Name of the instruction set in use.
[[nodiscard]] const char* instructionSet();

}  // namespace explica::repulsion::kernels
