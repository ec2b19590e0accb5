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
  std::vector<FlatPositions> frames;
  FlattenState state;
  int iterations = 0;  ///< at full resolution
  double energy = kNaN;
  Termination termination = Termination::NotRun;
};
/// Stopped early, the map is what the levels reached so far give: the vertices still missing are
/// put back where there is room for them.
/// @param areaError  mean area error of a map, which is to reach the options' tolerance
/// @throws InvalidInput  a state that does not fit the disc
[[nodiscard]] Laid layFlat(const IntrinsicDisc& disc,
                           const std::function<double(const FlatPositions&)>& areaError,
                           const FlattenOptions& options, const Monitor& monitor,
                           const FlattenState* resume = nullptr);

}  // namespace explica::flattening
