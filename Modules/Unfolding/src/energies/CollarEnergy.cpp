// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::unfolding {
namespace {

constexpr std::size_t kCollarGrain = 256;  // elements a task
constexpr double kCollarArea = 20;     // as the region's by default, so that the weight compares
constexpr double kCollarSpring = 2.4;  // the collar with the region
constexpr double kFree = 2;            // area ratio from which on stretching is held back ...
constexpr double kFull = 8;            // ... and up to which it shall stay
constexpr double kHold = 2;            // strength of that beside the visibility's, at kFull

/// What a face's area ratio costs: m(r) = strength k/2 (r - 1)^2 for each mm^2 of its weight, and
/// b(r) = kHold t^5, t = max(0, (r - kFree) / (kFull - kFree)), of its hold weight.
struct Stretching {
  double value = 0;      ///< mm^2
  double slope = 0;      ///< by the ratio
  double curvature = 0;  ///< by the ratio, >= 0
};

Stretching stretching(const PatchFace& face, double ratio, double strength) {
  constexpr double kRate = 1 / (kFull - kFree);
  const double membrane = strength * kCollarArea * face.weight;
  const double hold = kHold * face.holdWeight;
  const double t = std::max(0.0, (ratio - kFree) * kRate);
  const double t3 = t * t * t;
  return {0.5 * membrane * (ratio - 1) * (ratio - 1) + hold * t3 * t * t,
          membrane * (ratio - 1) + 5 * hold * t3 * t * kRate,
          membrane + 20 * hold * t3 * kRate * kRate};
}

/// strength * (sum over the collar's faces of w k/2 c^2 + s sum over its edges of e (l / l0 - 1)^2)
/// + sum over the collar's faces of h b(A / A0), with c = A / A0 - 1, k = kCollarArea,
/// s = kCollarSpring, b of stretching().
class CollarEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    const auto faces = now.patch.ofCollar();
    const double areas =
        parallelSum(faces.size(), kCollarGrain, 0.0, [&](std::size_t begin, std::size_t end) {
          double block = 0;
          for (std::size_t f = begin; f < end; ++f) {
            block += stretching(faces[f], shapeAt(now, f).area / faces[f].restArea, strength).value;
          }
          return block;
        });
    return areas + springValue(now.patch.collarEdges(), now.patch.yieldStrain, now.x,
                               strength * kCollarSpring);
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const auto faces = now.patch.ofCollar();
    std::vector<CornerForces> forces(faces.size());
    parallelFor(faces.size(), kCollarGrain, [&](std::size_t f) {
      const FaceShape& shape = shapeAt(now, f);
      const double ratio = shape.area / faces[f].restArea;
      const double tension = stretching(faces[f], ratio, strength).slope * ratio;
      for (int k = 0; k < 3; ++k) forces[f][k] = tension * shape.hat[k];
    });
    addForces(faces, forces, gradient);
    addSpringGradient(now.patch.collarEdges(), now.patch.yieldStrain, now.x,
                      strength * kCollarSpring, gradient);
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const auto faces = now.patch.ofCollar();
    std::vector<FaceStiffness> stiffness(faces.size());
    parallelFor(faces.size(), kCollarGrain, [&](std::size_t f) {
      const double ratio = shapeAt(now, f).area / faces[f].restArea;
      const Stretching stretch = stretching(faces[f], ratio, strength);
      const double inPlane = stretch.curvature * ratio * ratio;
      stiffness[f] = {inPlane, std::max(0.0, stretch.slope * ratio)};
    });
    addFaceBlocks(now.patch, now.shapes, now.patch.regionFaces, stiffness, unknown, system);
    addSpringStiffness(now.patch, now.patch.regionSprings, now.patch.collarEdges().size(), now.x,
                       strength * kCollarSpring, unknown, system);
  }

 private:
  static const FaceShape& shapeAt(const Configuration& now, std::size_t f) {
    return now.shapes[now.patch.regionFaces + f];
  }
};

}  // namespace

std::unique_ptr<Energy> makeCollarEnergy() {
  return std::make_unique<CollarEnergy>();
}

}  // namespace explica::unfolding
