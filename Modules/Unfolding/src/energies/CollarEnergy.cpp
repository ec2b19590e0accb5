// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::unfolding {
namespace {

constexpr std::size_t kGrain = 256;
constexpr double kCollarArea = 20;     // as the region's terms are by default, so that the weight
constexpr double kCollarSpring = 2.4;  // compares the collar with the region

/// strength * (sum over the collar's faces of w k/2 c^2 + s sum over its edges of e (l / l0 - 1)^2)
/// with c = A / A0 - 1, k = kCollarArea, s = kCollarSpring.
class CollarEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    const auto faces = now.patch.ofCollar();
    const double areas =
        parallelSum(faces.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
          double block = 0;
          for (std::size_t f = begin; f < end; ++f) {
            const double c = shapeAt(now, f).area / faces[f].restArea - 1;
            block += 0.5 * strength * kCollarArea * faces[f].weight * c * c;
          }
          return block;
        });
    return areas + springValue(now.patch.collarEdges(), now.x, strength * kCollarSpring);
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const auto faces = now.patch.ofCollar();
    std::vector<CornerForces> forces(faces.size());
    parallelFor(faces.size(), kGrain, [&](std::size_t f) {
      const FaceShape& shape = shapeAt(now, f);
      const double ratio = shape.area / faces[f].restArea;
      const double tension = strength * kCollarArea * faces[f].weight * (ratio - 1) * ratio;
      for (int k = 0; k < 3; ++k) forces[f][k] = tension * shape.hat[k];
    });
    addForces(faces, forces, gradient);
    addSpringGradient(now.patch.collarEdges(), now.x, strength * kCollarSpring, gradient);
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const auto faces = now.patch.ofCollar();
    std::vector<CornerBlocks> blocks(faces.size());
    parallelFor(faces.size(), kGrain, [&](std::size_t f) {
      const FaceShape& shape = shapeAt(now, f);
      const double ratio = shape.area / faces[f].restArea;
      const double stiffness = strength * kCollarArea * faces[f].weight * ratio;
      const Eigen::Matrix3d across =
          stiffness * std::max(0.0, ratio - 1) * shape.normal * shape.normal.transpose();
      int n = 0;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j <= i; ++j) {
          blocks[f][n++] = stiffness * ratio * shape.hat[i] * shape.hat[j].transpose() +
                           shape.hat[i].dot(shape.hat[j]) * across;
        }
      }
    });
    addBlocks(faces, blocks, unknown, system);
    addSpringStiffness(now.patch.collarEdges(), now.x, strength * kCollarSpring, unknown, system);
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
