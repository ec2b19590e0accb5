// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "SphereSolver.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::sphere {
namespace {

constexpr double kDamping = 1e-6;    // of the mean diagonal: holds rotations, which cost nothing
constexpr double kRounding = 1e-13;  // decrease that the energy, a mean of ones, can tell
constexpr double kFarthest = 0.5;    // length of a step on the unit sphere

}  // namespace

SphereSolver::SphereSolver(const SphereEnergy& energy, Eigen::Index vertexCount,
                           const VertexEnergy* beside)
    : energy_(energy),
      beside_(beside),
      system_(energy.faces(), vertexCount),
      frames_(static_cast<std::size_t>(vertexCount)),
      step_(Positions::Zero(vertexCount, 3)) {}

double SphereSolver::value(const Positions& sphere) const {
  const double value = energy_.value(sphere);
  return beside_ != nullptr && std::isfinite(value) ? value + beside_->value(sphere) : value;
}

bool SphereSolver::findStep(const Positions& sphere) {
  const auto& vertices = system_.vertices();
  parallelFor(vertices.size(), [&](std::size_t n) {
    frames_[vertices[n]] = tangentFrame(sphere.row(vertices[n]).transpose());
  });
  for (double damping = kDamping; damping < 1e3; damping *= 100) {
    system_.assemble([&](Eigen::Index f) { return energy_.term(sphere, frames_, f); });
    if (beside_ != nullptr) beside_->add(sphere, frames_, system_);
    system_.damp(damping);
    if (!system_.solve()) continue;
    double longest = 0;
    for (const std::int32_t v : vertices) {
      step_.row(v) = (frames_[v] * system_.stepAt(v)).transpose();
      longest = std::max(longest, step_.row(v).squaredNorm());
    }
    return std::isfinite(longest);
  }
  return false;
}

Positions SphereSolver::moved(const Positions& sphere, double share) const {
  Positions tried = sphere;
  const auto& vertices = system_.vertices();
  parallelFor(vertices.size(), [&](std::size_t n) {
    const std::int32_t v = vertices[n];
    tried.row(v) = (sphere.row(v) + share * step_.row(v)).normalized();
  });
  return tried;
}

double SphereSolver::largestShare(const Positions& sphere) const {
  const double longest = std::sqrt(step_.rowwise().squaredNorm().maxCoeff());
  return std::min(energy_.largestStep(sphere, step_), kFarthest / longest);
}

geometry::Descent SphereSolver::lower(Positions& sphere, int maxIterations, double tolerance,
                                      const Monitor& monitor) {
  return geometry::lowerByNewton(*this, sphere, {maxIterations, tolerance, kRounding}, monitor);
}

}  // namespace explica::sphere
