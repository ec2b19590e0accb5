// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::unfolding {
namespace {

constexpr std::size_t kOverhangGrain = 256;  // elements a task

/// strength * sum over the collar's faces of o max(0, -n . a)^2, a the room's axis.
///
/// A collar that leans over the region hides it, and has faces that look away where it turns back:
/// these are turned until they stand upright.
class OverhangEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    const auto faces = now.patch.ofCollar();
    return parallelSum(faces.size(), kOverhangGrain, 0.0, [&](std::size_t begin, std::size_t end) {
      double block = 0;
      for (std::size_t f = begin; f < end; ++f) {
        const double away = awayOf(now, f);
        if (away > 0) block += strength * faces[f].nearWeight * away * away;
      }
      return block;
    });
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const auto faces = now.patch.ofCollar();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const double away = awayOf(now, f);
      if (!(away > 0)) continue;
      const FaceShape& shape = shapeAt(now, f);
      const double scale = 2 * strength * faces[f].nearWeight * away;
      for (int k = 0; k < 3; ++k) {
        gradient.row(faces[f].vertices[k]) +=
            scale * shape.hat[k].dot(now.patch.room.axis) * shape.normal.transpose();
      }
    }
  }

  /// The stiffness of tension across the surface.
  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const auto faces = now.patch.ofCollar();
    std::vector<FaceStiffness> stiffness(faces.size());
    parallelFor(faces.size(), kOverhangGrain, [&](std::size_t f) {
      stiffness[f].across = 2 * strength * faces[f].nearWeight * awayOf(now, f);
    });
    addFaceBlocks(now.patch, now.shapes, now.patch.regionFaces, stiffness, unknown, system);
  }

 private:
  static const FaceShape& shapeAt(const Configuration& now, std::size_t f) {
    return now.shapes[now.patch.regionFaces + f];
  }
  /// How far a face looks away, -n . a; 0 without a say.
  static double awayOf(const Configuration& now, std::size_t f) {
    if (!(now.patch.ofCollar()[f].nearWeight > 0)) return 0;
    return std::max(0.0, -shapeAt(now, f).normal.dot(now.patch.room.axis));
  }
};

}  // namespace

std::unique_ptr<Energy> makeOverhangEnergy() {
  return std::make_unique<OverhangEnergy>();
}

}  // namespace explica::unfolding
