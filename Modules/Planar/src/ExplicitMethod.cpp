// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonVisibility.h"
#include "UnfoldingProblem.h"

#include <Eigen/SparseCholesky>

namespace explica::planar {
namespace {

// Share of the way to the first contact that a step may go.
constexpr double kContactShare = 0.5;

/// dv/dt = mu dE/dv - mu_R dE_R/dv, made tangent to the lengths' constraints.
class ExplicitMethod final : public UnfoldingMethod {
 public:
  explicit ExplicitMethod(UnfoldingProblem& problem) : problem_(problem) {}

  double advance() override {
    const PolygonUnfoldingOptions& options = problem_.options();
    const Curve& curve = problem_.curve();
    Positions2 flow = options.visibilityGain *
                      polygonVisibility(curve, problem_.region(), problem_.view()).gradient;
    flow -= options.repulsionGain * problem_.knot(curve).gradient;
    for (int v = 0; v < curve.vertexCount(); ++v) {
      if (!problem_.moving()[v]) flow.row(v).setZero();
    }
    project(flow);
    const double fastest = flow.rowwise().norm().maxCoeff();
    if (!(fastest > 0)) return 0;
    double step = options.explicitStep * problem_.meanEdge() / fastest;
    const std::vector<VertexEdgePair> pairs =
        problem_.pairsWithin(problem_.barrierRange() + 2 * step * fastest);
    const double safe = problem_.safeStep(curve.positions + step * flow, pairs);
    if (safe < 1) step *= kContactShare * safe;
    problem_.moveTo(curve.positions + step * flow);
    return step * fastest;
  }

 private:
  /// g - J' (J J')^-1 J g, [Thesis, Eq. 4.23].
  void project(Positions2& flow) const {
    const std::vector<int>& edges = problem_.keptEdges();
    if (edges.empty()) return;
    const Curve& curve = problem_.curve();
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t row = 0; row < edges.size(); ++row) {
      const int e = edges[row];
      const int f = curve.next(e);
      const Point2 t = (curve.point(f) - curve.point(e)).normalized();
      for (int axis = 0; axis < 2; ++axis) {
        entries.emplace_back(static_cast<int>(row), 2 * e + axis, -t[axis]);
        entries.emplace_back(static_cast<int>(row), 2 * f + axis, t[axis]);
      }
    }
    Eigen::SparseMatrix<double> jacobian(static_cast<int>(edges.size()), 2 * curve.vertexCount());
    jacobian.setFromTriplets(entries.begin(), entries.end());
    Eigen::Map<Eigen::VectorXd> g(flow.data(), flow.size());
    Eigen::SparseMatrix<double> product = jacobian * jacobian.transpose();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(product);
    g -= jacobian.transpose() * solver.solve(jacobian * g);
  }

  UnfoldingProblem& problem_;
};

}  // namespace

std::unique_ptr<UnfoldingMethod> makeExplicitMethod(UnfoldingProblem& problem) {
  return std::make_unique<ExplicitMethod>(problem);
}

}  // namespace explica::planar
