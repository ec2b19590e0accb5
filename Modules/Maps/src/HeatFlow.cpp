// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/HeatFlow.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SparseCholesky.h"

#include <numbers>

namespace explica::maps {
namespace {

constexpr double kGamma = 1 - 0.5 * std::numbers::sqrt2;  // the L-stable one of [Alexander1977]

/// The faces whose corners are all marked, on the same vertices.
TriangleMesh conducting(const TriangleMesh& mesh, const std::vector<bool>& domain) {
  TriangleMesh part{mesh.positions, Faces(mesh.faceCount(), 3)};
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const auto face = mesh.faces.row(f);
    if (domain[face[0]] && domain[face[1]] && domain[face[2]]) part.faces.row(kept++) = face;
  }
  part.faces.conservativeResize(kept, 3);
  return part;
}

}  // namespace

struct HeatFlow::State {
  Eigen::VectorXd masses;
  Eigen::VectorXd weights;  ///< masses, and 1 where there is none: such a value stays
  geometry::SparseCholesky solver;
};

HeatFlow::HeatFlow(const TriangleMesh& mesh, double step, const std::vector<bool>& domain)
    : state_(std::make_unique<State>()) {
  const TriangleMesh part = domain.empty() ? mesh : conducting(mesh, domain);
  state_->masses = geometry::vertexAreas(part);
  state_->weights = (state_->masses.array() > 0).select(state_->masses, 1.0);
  Eigen::SparseMatrix<double> matrix = kGamma * step * geometry::cotangentLaplacian(part);
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += state_->weights[v];
  state_->solver.compute(matrix);
  if (!state_->solver.isDefinite()) {
    throw InvalidInput("the surface's faces are too degenerate for diffusion along it");
  }
}

HeatFlow::~HeatFlow() = default;
HeatFlow::HeatFlow(HeatFlow&&) noexcept = default;

void HeatFlow::advance(Eigen::Ref<Eigen::MatrixXd> values) const {
  const State& s = *state_;
  parallelFor(static_cast<std::size_t>(values.cols()), 1, [&](std::size_t column) {
    auto u = values.col(column);
    const Eigen::VectorXd first = s.solver.solve(s.weights.cwiseProduct(u));
    // h L first = M (u - first) / gamma, so that the second stage needs no product with L.
    const Eigen::VectorXd start = u + (1 - kGamma) / kGamma * (first - u);
    u = s.solver.solve(s.weights.cwiseProduct(start));
  });
}

const Eigen::VectorXd& HeatFlow::masses() const {
  return state_->masses;
}

}  // namespace explica::maps
