// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Flattening/Flatten.h"

#include <functional>

namespace explica::flattening {

constexpr double kNeedleHeight = 1e-3;  // of the mean edge: lower faces get this height

/// A disc known by its edge lengths, its holes closed by fans.
struct IntrinsicDisc {
  IntrinsicMesh mesh;
  Loop rim;
  Eigen::Index surfaceFaces = 0;  ///< the faces after these are fans across holes
};

/// @return with edges shorter than a thousandth of the mean given that length: lengths divide
[[nodiscard]] IntrinsicDisc intrinsicDisc(const Disc& disc);

/// A disc with about so many of its vertices, their numbers in the finer one with it.
struct CoarseDisc {
  IntrinsicDisc disc;
  std::vector<std::int32_t> vertexOrigin;
};
[[nodiscard]] CoarseDisc coarseDisc(const IntrinsicDisc& fine, Eigen::Index vertices);

/// The map, not yet centred, turned and rounded.
struct Laid {
  FlatPositions positions;
  int iterations = 0;
  double energy = kNaN;
  double areaWeight = kNaN;
  Termination termination = Termination::NotRun;
};
/// @param areaError  mean area error of a map, which is to reach the options' tolerance
[[nodiscard]] Laid layFlat(const IntrinsicDisc& disc,
                           const std::function<double(const FlatPositions&)>& areaError,
                           const FlattenOptions& options, const Monitor& monitor);

}  // namespace explica::flattening
