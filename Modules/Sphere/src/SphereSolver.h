// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/NewtonDescent.h"
#include "Explica/Sphere/SphereEnergy.h"

namespace explica::sphere {

/// A further energy of positions on the sphere that is a sum over vertices.
struct VertexEnergy {
  virtual ~VertexEnergy() = default;
  [[nodiscard]] virtual double value(const Positions& sphere) const = 0;
  /// Adds gradient and a positive semi-definite Hessian.
  virtual void add(const Positions& sphere, const std::vector<TangentFrame>& frames,
                   geometry::FaceSystem& system) const = 0;
};

/// Lowers a SphereEnergy, and a VertexEnergy beside it, by projected Newton steps.
class SphereSolver {
 public:
  /// @param beside  kept by reference; may be null
  SphereSolver(const SphereEnergy& energy, Eigen::Index vertexCount,
               const VertexEnergy* beside = nullptr);

  /// Iterates until a step promises less than `tolerance` of the energy.
  /// @param sphere  unit vectors; rows of vertices without a face are left alone
  geometry::Descent lower(Positions& sphere, int maxIterations, double tolerance,
                          const Monitor& monitor);

  [[nodiscard]] double value(const Positions& sphere) const;
  [[nodiscard]] bool findStep(const Positions& sphere);
  [[nodiscard]] double promised() const { return system_.promised(); }
  [[nodiscard]] double largestShare(const Positions& sphere) const;
  [[nodiscard]] Positions moved(const Positions& sphere, double share) const;

 private:
  const SphereEnergy& energy_;
  const VertexEnergy* beside_;
  geometry::FaceSystem system_;
  std::vector<TangentFrame> frames_;
  Positions step_;
};

}  // namespace explica::sphere
