// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::unfolding {
namespace {

constexpr std::size_t kAreaGrain = 256;  // elements a task

/// sum over the region's faces of w (lambda c + strength/2 c^2) with c = A / A0 - 1.
class AreaEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    const auto faces = now.patch.ofRegion();
    return parallelSum(faces.size(), kAreaGrain, 0.0, [&](std::size_t begin, std::size_t end) {
      double block = 0;
      for (std::size_t f = begin; f < end; ++f) {
        const double c = now.shapes[f].area / faces[f].restArea - 1;
        block += faces[f].weight * c * (now.multipliers[f] + 0.5 * strength * c);
      }
      return block;
    });
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const auto faces = now.patch.ofRegion();
    std::vector<CornerForces> forces(faces.size());
    parallelFor(faces.size(), kAreaGrain, [&](std::size_t f) {
      const double tension = tensionOf(now, f, strength);
      for (int k = 0; k < 3; ++k) forces[f][k] = tension * now.shapes[f].hat[k];
    });
    addForces(faces, forces, gradient);
  }

  /// Gauss-Newton, and the stiffness of tension across the surface.
  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const auto faces = now.patch.ofRegion();
    std::vector<FaceStiffness> stiffness(faces.size());
    parallelFor(faces.size(), kAreaGrain, [&](std::size_t f) {
      const double ratio = now.shapes[f].area / faces[f].restArea;
      const double inPlane = faces[f].weight * strength * ratio * ratio;
      stiffness[f] = {inPlane, std::max(0.0, tensionOf(now, f, strength))};
    });
    addFaceBlocks(now.patch, now.shapes, 0, stiffness, unknown, system);
  }

 private:
  static double tensionOf(const Configuration& now, std::size_t f, double strength) {
    const PatchFace& face = now.patch.faces[f];
    const double ratio = now.shapes[f].area / face.restArea;
    return face.weight * (now.multipliers[f] + strength * (ratio - 1)) * ratio;
  }
};

}  // namespace

std::unique_ptr<Energy> makeAreaEnergy() {
  return std::make_unique<AreaEnergy>();
}

}  // namespace explica::unfolding
