// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "AtlasMap.h"

namespace explica::segmentation {

/// A hemisphere while it is put together.
struct Draft {
  VoxelSet own;     ///< tissue and fluid on its side
  VoxelSet white;   ///< white matter, and what counts as such
  VoxelSet filled;  ///< of these, what is not white by the segmentation
  VoxelSet tissue;  ///< white and grey matter

  /// Makes white matter of the voxels of a test; how many.
  template <class Test>
  std::int64_t fillWhere(const Test& test) {
    std::int64_t count = 0;
    for (std::size_t v = 0; v < white.size(); ++v) {
      if (!test(v)) continue;
      white[v] = filled[v] = 1;
      ++count;
    }
    return count;
  }
};

/// Takes the voxels of a test out of a set; how many.
template <class Test>
std::int64_t dropWhere(VoxelSet& set, const Test& test) {
  std::int64_t count = 0;
  for (std::size_t v = 0; v < set.size(); ++v) {
    if (set[v] == 0 || !test(v)) continue;
    set[v] = 0;
    ++count;
  }
  return count;
}

/// White matter and the deep structures, which count as such; how many voxels these add.
std::int64_t takeDeep(const VoxelSet& deep, const Volume<Label>& seg, Draft& draft);

/// Fills voids that border deep structures and do not open to the outside, and those that the atlas
/// says are ventricles, with all that is nearer to them, by steps through voids, than to what is
/// none: choroid fissure and foramina join ventricles and cisterns.  How many voxels.
std::int64_t fillVentricles(const VoxelSet& voidSet, const VoxelSet& deep,
                            const VoxelSet& ventricle, const Volume<Label>& seg, Draft& draft);

/// Fills fluid that borders what is filled, and that tissue closes off from the outside: what an
/// atlas leaves of the ventricles, as temporal horns in the midst of cortical labels.  The voxels.
VoxelSet fillClosedFluid(const Volume<Label>& seg, Draft& draft);

/// Fills grey matter that is nearer to deep structures than to the outside, by ways through grey
/// matter, and deeper than cortex is: what an atlas leaves of hippocampus and amygdala would be
/// cortex without an outside, and the surface would open a sulcus between them and the gyrus below.
/// How many voxels.
std::int64_t takeMesialRim(VoxelSet deep, const Volume<Label>& seg, Draft& draft);

/// Only the largest piece of a set counts; how many voxels that leaves out.
std::int64_t keepLargest(VoxelSet& set, const Components& pieces);

/// Takes off what is joined to white matter by a thread and has no cortex about it, as fat of the
/// orbit that stripping has left; how many voxels.
std::int64_t dropHanging(VoxelSet& white, const Volume<Label>& seg);

/// Fills what white matter encloses; how many voxels.
std::int64_t fillCavities(Draft& draft);

/// Takes off tissue that is farther from white matter than cortex is thick; how many voxels.
std::int64_t dropFarFromWhite(Draft& draft);

}  // namespace explica::segmentation
