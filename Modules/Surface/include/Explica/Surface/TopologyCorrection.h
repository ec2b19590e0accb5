// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/LevelSet.h"

#include <array>
#include <cstdint>
#include <vector>

namespace explica::surface {

/// What was wrong with the segmentation at one place.
enum class DefectKind {
  Handle,  ///< a bridge of foreground, cut
  Tunnel,  ///< a hole through foreground, filled
  Island,  ///< foreground that is not connected to the rest, removed
  Cavity   ///< background enclosed by foreground, filled
};
constexpr auto enumWords(DefectKind) {
  using enum DefectKind;
  return std::to_array<EnumWord<DefectKind>>(
      {{Handle, "handle"}, {Tunnel, "tunnel"}, {Island, "island"}, {Cavity, "cavity"}});
}

/// Whether handles and tunnels are removed.
enum class GenusRule {
  Zero,  ///< the surface becomes a sphere
  Keep   ///< handles and tunnels stay; islands and cavities do not
};
constexpr auto enumWords(GenusRule) {
  return std::to_array<EnumWord<GenusRule>>({{GenusRule::Zero, "zero"}, {GenusRule::Keep, "keep"}});
}

/// One correction.
struct Defect {
  DefectKind kind = DefectKind::Handle;
  Point place = Point::Zero();    ///< centre of the changed voxels, RAS mm
  std::int64_t voxels = 0;        ///< changed
  double cost = 0;                ///< sum of |level| over them: evidence overruled
  double alternativeCost = kNaN;  ///< of the other side's correction; NaN if there was none
};

struct TopologyResult {
  LevelSet level;               ///< as given, with the sign of changed voxels turned
  std::vector<Defect> defects;  ///< largest first
  std::int64_t voxelsChanged = 0;
  std::int64_t handlesLeft = 0;  ///< genus of the result; 0 unless GenusRule::Keep
};

/// Makes the set of positive voxels a ball in the sense of the Freudenthal triangulation of the
/// lattice: connected, without cavity, without handle; so that its boundary, which
/// extractIsoSurface() gives, is a sphere.
///
/// Two homotopic growths bound the correction from both sides: from the deepest voxel outward,
/// deepest first, within the foreground (what it cannot reach are cuts), and from the border of
/// the box inward, farthest first, outside the foreground (what it cannot reach are fills).  Both
/// are balls, so each connected piece between them may be left out or added as a whole: its cuts or
/// its fills, whichever overrule less evidence; of fills, what the ball does not need is taken
/// back. Ranks are Euclidean distances in mm, so anisotropic voxels are treated alike.
///
/// @param level  positive inside, nowhere 0, negative on the border of the box
/// @throws InvalidInput  no positive voxel, or one on the border of the box
/// Does not depend on the number of threads.
[[nodiscard]] TopologyResult correctTopology(const LevelSet& level,
                                             GenusRule rule = GenusRule::Zero,
                                             const Monitor& monitor = {});

/// Euler characteristic of the boundary between positive and negative voxels.
[[nodiscard]] std::int64_t boundaryEulerCharacteristic(const LevelSet& level);

/// Share of a surface's area that lies between voxels of which the correction changed one.
/// @param mesh  boundary of the positive voxels of `after`, mm
[[nodiscard]] double correctedShare(const LevelSet& before, const LevelSet& after,
                                    const TriangleMesh& mesh);

}  // namespace explica::surface
