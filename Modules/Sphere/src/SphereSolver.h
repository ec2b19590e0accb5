// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
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

  struct Run {
    int iterations = 0;
    double energy = kNaN;
    Termination termination = Termination::NotRun;
  };
  /// Iterates until a step promises less than `tolerance` of the energy.
  /// @param sphere  unit vectors; rows of vertices without a face are left alone
  Run lower(Positions& sphere, int maxIterations, double tolerance, const Monitor& monitor);

  [[nodiscard]] double value(const Positions& sphere) const;

 private:
  [[nodiscard]] bool findStep(const Positions& sphere);
  [[nodiscard]] Positions moved(const Positions& sphere, double share) const;

  const SphereEnergy& energy_;
  const VertexEnergy* beside_;
  geometry::FaceSystem system_;
  std::vector<TangentFrame> frames_;
  Positions step_;
};

}  // namespace explica::sphere
