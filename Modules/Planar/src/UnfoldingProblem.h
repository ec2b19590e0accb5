// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Planar/PolygonCollision.h"
#include "Explica/Planar/PolygonUnfolding.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace explica::planar {

/// Sizes of the start that later states are measured by.
struct StartSizes {
  double meanEdge = 0;  ///< of the region, mm
  double length = 0;    ///< of the region, mm
};

/// What both methods share: who moves, which lengths are kept, and the energies.
class UnfoldingProblem {
 public:
  UnfoldingProblem(const Curve& curve, const Region& region, const Viewpoints& view,
                   const PolygonUnfoldingOptions& options, const StartSizes& start);

  [[nodiscard]] const Curve& curve() const { return curve_; }
  [[nodiscard]] const Region& region() const { return region_; }
  [[nodiscard]] const Viewpoints& view() const { return view_; }
  [[nodiscard]] const PolygonUnfoldingOptions& options() const { return options_; }
  [[nodiscard]] const std::vector<int>& movers() const { return movers_; }
  [[nodiscard]] int slot(int vertex) const { return slots_[vertex]; }  ///< among movers, or -1
  [[nodiscard]] const std::vector<bool>& moving() const { return moving_; }
  [[nodiscard]] const std::vector<int>& keptEdges() const { return keptEdges_; }
  [[nodiscard]] const std::vector<int>& softEdges() const { return softEdges_; }
  [[nodiscard]] double restLength(int edge) const { return restLengths_[edge]; }
  [[nodiscard]] double meanEdge() const { return start_.meanEdge; }
  [[nodiscard]] double initialLength() const { return start_.length; }

  void moveTo(const Positions2& positions) { curve_.positions = positions; }

  /// Knot energy of `curve`, or zeros if there is none.
  [[nodiscard]] PolygonKnotValue knot(const Curve& curve);
  /// Vertex-edge pairs of the present curve within `reach`; none without topology preservation.
  [[nodiscard]] std::vector<VertexEdgePair> pairsWithin(double reach);
  [[nodiscard]] double safeStep(const Positions2& target, const std::vector<VertexEdgePair>& pairs);
  [[nodiscard]] double barrierRange() const;

  /// The curve and region with one edge that has shrunk away merged into a vertex; nothing if no
  /// edge is that short or if merging would sweep over another vertex or edge.
  [[nodiscard]] std::optional<std::pair<Curve, Region>> merged();

  [[nodiscard]] PolygonIteration account();
  [[nodiscard]] double secondsTopology() const { return secondsTopology_; }

 private:
  Curve curve_;
  Region region_;
  Viewpoints view_;
  PolygonUnfoldingOptions options_;
  std::vector<bool> moving_;
  std::vector<int> movers_;
  std::vector<int> slots_;
  std::vector<int> keptEdges_;
  std::vector<int> softEdges_;
  Eigen::VectorXd restLengths_;
  std::optional<PolygonKnotEnergy> knot_;  ///< once it is known who moves
  StartSizes start_;
  double lastKnot_ = 0;
  double lastLeastDistance_ = kInfinity;
  double secondsTopology_ = 0;
};

/// One iteration after the other on a problem that outlives it.
class UnfoldingMethod {
 public:
  virtual ~UnfoldingMethod() = default;
  /// Moves the problem's curve; returns the largest motion of a vertex, mm, 0 if none was found.
  /// @throws Interrupted  the curve is as before, the state may not be
  virtual double advance() = 0;
  /// What the next iteration takes from those before, besides the curve.
  [[nodiscard]] virtual PolygonMethodState state() const { return {}; }
  virtual void restore(const PolygonMethodState&) {}
};

[[nodiscard]] std::unique_ptr<UnfoldingMethod> makeImplicitMethod(UnfoldingProblem& problem);
[[nodiscard]] std::unique_ptr<UnfoldingMethod> makeExplicitMethod(UnfoldingProblem& problem);

}  // namespace explica::planar
