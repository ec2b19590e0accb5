// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Flattening/MapEnergy.h"
#include "Explica/Flattening/RimContact.h"
#include "Explica/Geometry/FaceSystem.h"

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
  void assemble(const FlatPositions& flat);
  void addContacts(const FlatPositions& flat);

  MapEnergy energy_;
  RimContact contact_;
  geometry::FaceSystem system_;
};

}  // namespace explica::flattening
