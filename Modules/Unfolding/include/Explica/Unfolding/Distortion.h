// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Core/TriangleMesh.h"

#include <span>

namespace explica::unfolding {

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
};

/// Compares the listed faces of two embeddings of the same mesh.  Faces of zero reference area
/// count as ratio 1.
/// @throws InvalidInput  sizes that differ, or no face
[[nodiscard]] Distortion measureDistortion(const TriangleMesh& reference, const Positions& deformed,
                                           std::span<const std::int32_t> faces);

inline void describe(Results& t, const Distortion& d) {
  t.share("area_error_mean", "Mean area error", "Mean of |area ratio - 1| over faces.",
          d.areaErrorMean)
      .inHead()
      .compared();
  t.share("area_error_max", "Largest area error", "", d.areaErrorMax);
  t.share("edge_strain_mean", "Mean change of lengths", "Mean of |length ratio - 1| over edges.",
          d.edgeStrainMean)
      .inHead()
      .compared();
  t.share("edge_strain_p95", "Change of lengths, 95th percentile", "", d.edgeStrainP95);
  t.number("angle_error_mean_deg", "Mean change of angles", "degrees",
           "Largest change of a face's three angles, mean over faces.",
           d.angleErrorMeanRad * 180 / kPi)
      .inHead();
}

/// Areas that a deformation is meant to keep.
inline void expectAreasKept(Results& t) {
  t["area_error_mean"]
      .atMost(0.02, Judgement::Look, "areas on a printed map are read to a few per cent")
      .atMost(0.10, Judgement::Doubt, "more is seen by eye");
}

}  // namespace explica::unfolding
