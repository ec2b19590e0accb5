// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Visibility/Viewpoints.h"

#include <vector>

namespace explica::visibility {

/// Average visibility of a region and how it changes with the vertices.
struct VisibilityValue {
  double value = 0;          ///< in [-1, 1]: total flux over total area
  double area = 0;           ///< of the region, mm^2
  Positions gradient;        ///< V x 3, 1/mm; zero rows off the region
  Eigen::VectorXd faceFlux;  ///< flux over area of each region face, in [-1, 1]; 0 for zero area
};

/// E = (sum of the fluxes of the region's faces) / (sum of their areas), [Thesis, Eq. 5.26],
/// averaged over the viewpoints; gradient of [Thesis, Eq. 5.37].
///
/// To be maximised: the gradient ascends.  A region of negative average visibility cannot be
/// unfolded
/// ([Thesis, section 5.1]): the flow is then a backward diffusion.
class AverageVisibility {
 public:
  /// @param faces        F x 3 of the whole surface
  /// @param regionFaces  rows of `faces`
  /// @throws InvalidInput  empty region, face out of range, or no viewpoint
  AverageVisibility(const Faces& faces, const std::vector<std::int32_t>& regionFaces,
                    Viewpoints viewpoints);

  /// @param positions  V x 3
  [[nodiscard]] VisibilityValue evaluate(const Positions& positions) const;
  /// Value alone, without the gradient.
  [[nodiscard]] double value(const Positions& positions) const;

 private:
  Faces faces_;  ///< R x 3: of the region only
  Viewpoints viewpoints_;
};

/// Mean flux at each vertex: of its faces, by area; in [-1, 1], zero at vertices of no face.
[[nodiscard]] Eigen::VectorXd vertexFlux(const TriangleMesh& mesh, const Viewpoints& viewpoints);

}  // namespace explica::visibility
