// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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
  float second[6]
              [kLanes];  ///< xx, yy, zz, xy, xz, yz of the area about the centroid, over the area
  float radius[kLanes];  ///< farthest corner from the centroid
  std::int32_t vertex[3][kLanes];
  float phi[2][3][kLanes];  ///< [source set][quadrature point][face]
  float g[3][3][kLanes];    ///< [quadrature point][axis][face]
};

/// A source face with its quadrature points, relative to its group's centre.
struct alignas(64) SourceFace {
  float point[3][4];  ///< x, y, z, a third of the area
  float centroid[3];
  float radius;
};

/// Sources seen as one: mass, centre seen from the target's, second moments.
struct FarNode {
  float centre[3];
  float mass;
  float xx, yy, zz, xy, xz, yz;
};

/// Mass and second moments of a source.
struct PartMoments {
  float mass;
  float xx, yy, zz, xy, xz, yz;
};

/// A node of at most sixteen faces with the nodes two levels below it, or one of four faces with
/// its parts and its faces: whole, halves, quarters.
struct alignas(32) SourcePack {
  static constexpr int kEntries = 7;
  float x[8], y[8], z[8];  ///< centres, relative to the group's
  float reach[8];          ///< distance from a target face from which an entry's moments are enough
  float margin[8];  ///< distance beyond `nearRatio` radii of a target from which no face is near
  PartMoments part[kEntries];
  std::int32_t first[4];  ///< quarters: the pack below, or the face
  std::uint32_t present;  ///< which entries exist, one bit each
};

/// Groups of sources near the targets.
struct CloseGroup {
  const SourcePack* pack;
  float offset[4];  ///< its centre seen from the target's, and zero
};

/// What the quarters of close groups stand for.
struct CloseSources {
  const SourcePack* leaves;
  const SourceFace* faces;
  const std::array<std::int32_t, 3>* vertices;
  const std::uint16_t* targetsAt;  ///< of each vertex: the targets that have it, one bit each
};

/// A source face too near for the quadrature of some targets, one bit each; those that have no
/// vertex in common with it.
struct NearHit {
  std::int32_t face;
  std::uint32_t targets;
};

/// A source face that acts by its quadrature points, on the targets that it is not near: the others
/// take no weight.
struct alignas(64) MaskedFace {
  float weight[kLanes];
  float point[3][4];
};

/// A leaf to be opened: its pack and its group's centre seen from the target's.
struct OpenLeaf {
  const SourcePack* pack;
  const float* offset;
};

/// Room for what addCloseGroups() sorts its sources into: sixteen a group, and one more, each; hits
/// twice that.
struct CloseRoom {
  FarNode* nodes;
  OpenLeaf* leaves;
  MaskedFace* faces;
  NearHit* hits;
};

/// Adds what far nodes contribute.  Both sides count by their second moments: the mean of 1/r^2
/// over a node and a face is that of their centres and half its second derivative contracted with
/// the sum of their second moments; across the face, the field varies by its second derivatives.
/// @param shift  centre of the target as the nodes see it
void addFarNodes(TargetLeaf& target, int set, const FarNode* nodes, std::size_t count,
                 const float* shift);

/// Adds near sources: nodes and single faces by their moments where they are enough for all
/// targets, three by three quadrature points for faces nearer than that whose centroids are at
/// least `nearRatio` sums of radii apart; lists the other pairs.
/// @return number of hits
std::size_t addCloseGroups(TargetLeaf& target, int set, const CloseGroup* groups, std::size_t count,
                           const CloseSources& sources, float nearRatio, const CloseRoom& room);

/// Means of 1/|x - y|^2 over pairs of triangles and derivatives by the first one's corners.
struct alignas(64) ApartBatch {
  float s[9][kLanes];  ///< corner k, axis a at 3 k + a
  float t[9][kLanes];
  float value[kLanes];
  float byS[9][kLanes];
};
/// @param fine  twelve points a triangle instead of seven
void integrateApart(ApartBatch& batch, bool fine);

/// Name of the instruction set in use.
[[nodiscard]] const char* instructionSet();

}  // namespace explica::repulsion::kernels
