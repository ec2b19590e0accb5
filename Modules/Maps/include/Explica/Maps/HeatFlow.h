// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <memory>
#include <vector>

namespace explica::maps {

/// One implicit step of the heat equation du/dt = div grad u along a surface.
///
/// Linear finite elements with lumped masses M and cotangent stiffness L, no flux across the
/// boundary; in time the two-stage method of order 2 of [Alexander1977], L-stable, both stages with
/// the one factorised matrix M + gamma h L.  Constants stay, and so does the integral 1' M u of
/// every map.  O(V^1.5) to set up, O(V log V) a map and step.
class HeatFlow {
 public:
  /// @param step    h, mm^2; a point source has the variance 2 h along each direction after it
  /// @param domain  V marks, or empty for all: faces with an unmarked corner conduct nothing, and
  ///                vertices without a face keep their values
  HeatFlow(const TriangleMesh& mesh, double step, const std::vector<bool>& domain = {});
  ~HeatFlow();
  HeatFlow(HeatFlow&&) noexcept;

  /// One step of each column of `values` (V x n).  Threads take columns; bytes do not depend on
  /// them.
  void advance(Eigen::Ref<Eigen::MatrixXd> values) const;

  /// Lumped masses of the conducting faces, V, mm^2.
  [[nodiscard]] const Eigen::VectorXd& masses() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace explica::maps
