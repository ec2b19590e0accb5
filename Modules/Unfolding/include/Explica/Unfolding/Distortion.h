// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <span>

namespace explica::unfolding {

struct DistortionOptions {
  int geodesicSources =
      20;             ///< vertices from which distances along the surface are compared; 0: none
  unsigned seed = 1;  ///< of their choice
};

/// How a deformed patch differs from the reference that it came from.
struct Distortion {
  Eigen::VectorXd areaRatio;      ///< per listed face: deformed area over reference area
  Eigen::VectorXd angleErrorRad;  ///< per listed face: largest change of its three angles
  Eigen::VectorXd edgeStrain;     ///< per edge of the listed faces: |length / reference - 1|
  double areaErrorMean = kNaN;    ///< mean of |areaRatio - 1|
  double areaErrorMax = kNaN;
  double angleErrorMeanRad = kNaN;
  double edgeStrainMean = kNaN;
  double edgeStrainP95 = kNaN;
  double geodesicErrorMean = kNaN;  ///< mean |d / d0 - 1| within the patch; NaN if not asked for
};

/// Compares the listed faces of two embeddings of the same mesh.  Faces of zero reference area
/// count as ratio 1.
/// @throws InvalidInput  sizes that differ, or no face
[[nodiscard]] Distortion measureDistortion(const TriangleMesh& reference, const Positions& deformed,
                                           std::span<const std::int32_t> faces,
                                           const DistortionOptions& options = {});

}  // namespace explica::unfolding
