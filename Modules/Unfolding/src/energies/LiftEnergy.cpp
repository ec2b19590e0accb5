// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../Room.h"
#include "Energy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::unfolding {
namespace {

constexpr std::size_t kLiftGrain = 256;  // elements a task

// Of the room's radius: beyond this the pull grows no more, so that a deep region is not dragged
// through a narrow opening before the folds above have made way.
constexpr double kFirm = 0.03;

/// How a deficit counts: its square over two, from kFirm of the radius on a straight line; in units
/// of the radius.
struct Shortfall {
  double value = 0;
  double slope = 0;
  double curvature = 0;  ///< of the parabola that touches there from above
};

Shortfall shortfall(const PatchRoom& room, const Point& place) {
  const double share = deficitOf(room, place) / room.radius;
  if (!(share > 0)) return {};
  if (share <= kFirm) return {0.5 * share * share, share, 1};
  return {kFirm * (share - 0.5 * kFirm), kFirm, kFirm / share};
}

/// strength * sum over the region's faces of w h(deficit / radius), h of shortfall().
class LiftEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    if (!(strength > 0)) return 0;
    const auto faces = now.patch.ofRegion();
    const PatchRoom& room = now.patch.room;
    return parallelSum(faces.size(), kLiftGrain, 0.0, [&](std::size_t begin, std::size_t end) {
      double block = 0;
      for (std::size_t f = begin; f < end; ++f) {
        block += strength * faces[f].weight * shortfall(room, centroidOf(faces[f], now.x)).value;
      }
      return block;
    });
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    if (!(strength > 0)) return;
    const PatchRoom& room = now.patch.room;
    for (const PatchFace& face : now.patch.ofRegion()) {
      const double pull =
          strength * face.weight / room.radius * shortfall(room, centroidOf(face, now.x)).slope;
      for (const std::int32_t v : face.vertices) {
        gradient.row(v) -= pull / 3 * room.axis.transpose();
      }
    }
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    if (!(strength > 0)) return;
    const auto faces = now.patch.ofRegion();
    const PatchRoom& room = now.patch.room;
    const Eigen::Matrix3d along = room.axis * room.axis.transpose();
    std::vector<double> scales(faces.size());
    parallelFor(faces.size(), kLiftGrain, [&](std::size_t f) {
      scales[f] = strength * faces[f].weight / (9 * room.radius * room.radius) *
                  shortfall(room, centroidOf(faces[f], now.x)).curvature;
    });
    addBlocks(
        now.patch.facesAround, 0, faces.size(), [&](std::int32_t f) { return faces[f].vertices; },
        unknown, system,
        [&](std::int32_t f, int, int) -> Eigen::Matrix3d { return scales[f] * along; });
  }
};

}  // namespace

std::unique_ptr<Energy> makeLiftEnergy() {
  return std::make_unique<LiftEnergy>();
}

}  // namespace explica::unfolding
