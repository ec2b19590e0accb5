// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/MapEnergy.h"

#include <vector>

namespace explica::flattening {

/// A vertex taken out of a mesh, and how to put it back.
struct Removal {
  std::int32_t vertex = -1;
  bool onRim = false;
  std::vector<double> spokes;  ///< lengths from the vertex to the ring, mm
  std::vector<double> outer;   ///< lengths along the ring, from each place to the next
  Loop ring;  ///< its neighbours, counter-clockwise; the first is the one it merged with.
              ///< On the rim the list is open, in whichever direction keeps faces positive
};

/// One state of the mesh on the way down, and what was removed after it.
struct CoarseningLevel {
  IntrinsicMesh mesh;             ///< faces name vertices of the finest mesh
  Loop rim;                       ///< at this level
  std::vector<Removal> removals;  ///< in order, between this level and the next coarser one
};

/// Takes vertices out of a disc without holes or of a closed surface of genus 0, evenly, until
/// about `smallest` are left; a closed surface can be taken down to 4.
///
/// The surface is treated as its edge lengths alone: the length of a new edge is that of the
/// straight way through the faces about the removed vertex, unfolded.  So a coarse level keeps the
/// distances of the folds which its vertices can no longer show [Shen2019 insert vertices again in
/// the reverse order, which a one-to-one map always allows].
/// @param rim       empty for a closed surface
/// @param anyShape  do not stop short of `smallest` where only needles would be left
/// @return levels from the finest on; the last has no removals
[[nodiscard]] std::vector<CoarseningLevel> coarsen(const IntrinsicMesh& mesh, const Loop& rim,
                                                   Eigen::Index smallest, bool anyShape = false);

/// Puts removed vertices back into a map, the last one first.
class Insertion {
 public:
  /// @param rim  of the level from which vertices were removed
  Insertion(const Loop& rim, Eigen::Index vertexCount, double areaWeight);

  /// Places a vertex so that every face about it is positive and the rim does not meet itself; as
  /// far as that goes, where the energy of these faces is least.
  /// @return false if rounding leaves no room
  [[nodiscard]] bool insert(const Removal& removal, FlatPositions& flat);

 private:
  [[nodiscard]] bool clearOfRim(std::int32_t before, std::int32_t after,
                                const Eigen::Vector2d& place, const FlatPositions& flat) const;

  double areaWeight_;
  std::vector<std::int32_t> next_;  ///< along the rim, -1 off it
  std::int32_t first_ = -1;
};

}  // namespace explica::flattening
