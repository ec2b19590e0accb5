// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Flattening/MapEnergy.h"
#include "Explica/Flattening/RimContact.h"
#include "Explica/Geometry/BlockCholesky.h"

#include <array>
#include <functional>
#include <vector>

namespace explica::flattening {

/// Lowers the energy of one level's map by projected Newton steps.
class MapSolver {
 public:
  /// @param faceWeights  how much each face counts; all 1 if empty
  MapSolver(const IntrinsicMesh& mesh, const Loop& rim, double areaWeight, double contactRange,
            std::vector<double> faceWeights = {});

  struct Run {
    int iterations = 0;
    double energy = kNaN;
    Termination termination = Termination::NotRun;
  };
  /// Iterates until a step promises less than `tolerance` of the energy, or less than rounding lets
  /// the energy tell: a sheet that unrolls has none.  An iteration depends on nothing but the map,
  /// so that a run can go on from where it was stopped.
  /// @param taken  called after every step with the number of iterations
  Run lower(FlatPositions& flat, int maxIterations, double tolerance, const Monitor& monitor,
            const std::function<void(int)>& taken = {});

  [[nodiscard]] double value(const FlatPositions& flat) const;
  void setAreaWeight(double weight) { energy_.setAreaWeight(weight); }

 private:
  /// Where a face's six blocks lie in the matrix: corners 00, 11, 22, 10, 20, 21.
  struct FaceBlocks {
    std::array<std::int32_t, 6> at;
    std::array<bool, 6> turned;  ///< the block's transpose belongs there
  };

  void buildPattern();
  [[nodiscard]] std::int32_t slot(std::int32_t row, std::int32_t column) const;
  void assemble(const FlatPositions& flat, Eigen::VectorXd& gradient);
  void addFaces(const FlatPositions& flat, Eigen::VectorXd& gradient);
  void addContacts(const FlatPositions& flat, Eigen::VectorXd& gradient);

  MapEnergy energy_;
  RimContact contact_;
  std::vector<std::int32_t> used_;   ///< vertices of this level, ascending
  std::vector<std::int32_t> place_;  ///< of each vertex in the elimination order, or -1
  geometry::BlockPattern pattern_;
  std::vector<Eigen::Matrix2d> blocks_;  ///< of the pattern's entries
  std::vector<FaceBlocks> faceBlocks_;
  geometry::BlockCholesky<2> cholesky_;
};

}  // namespace explica::flattening
