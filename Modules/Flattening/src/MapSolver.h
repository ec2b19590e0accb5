// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/MapEnergy.h"
#include "Explica/Flattening/RimContact.h"
#include "Explica/Geometry/FaceSystem.h"
#include "Explica/Geometry/NewtonDescent.h"

#include <functional>
#include <vector>

namespace explica::flattening {

/// Lowers the energy of one level's map by projected Newton steps.
class MapSolver {
 public:
  /// @param faceWeights  how much each face counts; all 1 if empty
  MapSolver(const IntrinsicMesh& mesh, const Loop& rim, double areaWeight, double contactRange,
            std::vector<double> faceWeights = {});

  /// Iterates until a step promises less than `tolerance` of the energy, or less than rounding lets
  /// the energy tell: a sheet that unrolls has none.
  /// @param taken  called after every step with the number of iterations
  geometry::Descent lower(FlatPositions& flat, int maxIterations, double tolerance,
                          const Monitor& monitor, const std::function<void(int)>& taken = {});

  [[nodiscard]] double value(const FlatPositions& flat) const;
  [[nodiscard]] bool findStep(const FlatPositions& flat);
  [[nodiscard]] double promised() const { return system_.promised(); }
  [[nodiscard]] double largestShare(const FlatPositions& flat) const;
  [[nodiscard]] FlatPositions moved(const FlatPositions& flat, double share) const {
    return flat + share * step_;
  }
  void setAreaWeight(double weight) { energy_.setAreaWeight(weight); }

 private:
  void assemble(const FlatPositions& flat);
  void addContacts(const FlatPositions& flat);

  MapEnergy energy_;
  RimContact contact_;
  geometry::FaceSystem system_;
  FlatPositions step_;
};

}  // namespace explica::flattening
