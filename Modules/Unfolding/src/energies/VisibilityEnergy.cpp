// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

namespace explica::unfolding {
namespace {

constexpr std::size_t kVisibilityGrain = 256;  // elements a task

struct MeanDirection {
  Vector direction = Vector::Zero();                     ///< at most 1 long
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();  ///< by the place looked at, symmetric
};

MeanDirection directionFrom(const Point& place, const visibility::Viewpoints& viewpoints) {
  MeanDirection mean;
  for (std::size_t k = 0; k < viewpoints.points.size(); ++k) {
    const Vector towards = viewpoints.points[k] - place;
    const double distance = towards.norm();
    const Vector unit = towards / distance;
    mean.direction += viewpoints.weights[k] * unit;
    mean.derivative +=
        viewpoints.weights[k] / distance * (unit * unit.transpose() - Eigen::Matrix3d::Identity());
  }
  return mean;
}

/// Where a face of the region is to look: along a direction of its own, or towards the viewpoints.
MeanDirection directionOf(const Configuration& now, std::size_t face) {
  if (now.directions != nullptr) {
    return {now.directions->row(static_cast<Eigen::Index>(face)).transpose(),
            Eigen::Matrix3d::Zero()};
  }
  return directionFrom(centroidOf(now.patch.faces[face], now.x), now.viewpoints);
}

/// strength * sum over the region's faces of w (1 - n . d).
///
/// With areas kept this is the area times one less the average visibility [Thesis, Eq. 5.26]; off
/// that constraint it differs: every face feels a torque towards the viewpoint, where the flux
/// itself pulls at the rim only, and no face gains by growing.
class VisibilityEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    const auto faces = now.patch.ofRegion();
    return parallelSum(faces.size(), kVisibilityGrain, 0.0,
                       [&](std::size_t begin, std::size_t end) {
                         double block = 0;
                         for (std::size_t f = begin; f < end; ++f) {
                           const Vector d = directionOf(now, f).direction;
                           block += faces[f].weight * (1 - now.shapes[f].normal.dot(d));
                         }
                         return strength * block;
                       });
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const auto faces = now.patch.ofRegion();
    std::vector<CornerForces> forces(faces.size());
    parallelFor(faces.size(), kVisibilityGrain, [&](std::size_t f) {
      const FaceShape& shape = now.shapes[f];
      const MeanDirection look = directionOf(now, f);
      const double scale = strength * faces[f].weight;
      const Vector shift = scale / 3 * (look.derivative * shape.normal);
      for (int k = 0; k < 3; ++k) {
        forces[f][k] = scale * shape.hat[k].dot(look.direction) * shape.normal - shift;
      }
    });
    addForces(faces, forces, gradient);
  }

  /// The stiffness of tension across the surface.
  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const auto faces = now.patch.ofRegion();
    std::vector<FaceStiffness> stiffness(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) stiffness[f].across = strength * faces[f].weight;
    addFaceBlocks(now.patch, now.shapes, 0, stiffness, unknown, system);
  }
};

}  // namespace

std::unique_ptr<Energy> makeVisibilityEnergy() {
  return std::make_unique<VisibilityEnergy>();
}

}  // namespace explica::unfolding
