// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Correspondence.h"

#include <array>
#include <vector>

namespace explica::correspondence {

/// What layers of equal rank have in common.
enum class LayerKind {
  Depth,  ///< the same share of the thickness
  Volume  ///< the same share of the volume of the column that they lie in [Bok1929]
};
constexpr auto enumWords(LayerKind) {
  using enum LayerKind;
  return std::to_array<EnumWord<LayerKind>>({{Depth, "depth"}, {Volume, "volume"}});
}

struct LayerOptions {
  int layers = 3;  ///< number of layers, numbered from 1 at the inner boundary
  LayerKind layerKind = LayerKind::Depth;
};

template <class Visitor>
void describe(LayerOptions& options, Visitor&& visit) {
  visit(Field{"layers", "", "number of layers, counted from the inner boundary", 1, 1000},
        options.layers);
  visit(Field{"layer-kind", "", "layers of equal share of the thickness or of the column's volume"},
        options.layerKind);
}

/// Normalised depth L0 / (L0 + L1) per tissue voxel; NaN where a length is.
[[nodiscard]] std::vector<double> depthOf(const Correspondence& correspondence);

/// Share of its column's volume that lies below each tissue voxel, in [0, 1].
///
/// A thin bundle of trajectories has cross-section a(s); grad u . T a is constant along it (flux),
/// so a = 1 / |grad u| up to a factor, and the share is integral_0^L0 ds/|grad u| over the integral
/// to the thickness, by Simpson's rule on the trajectory's own points.
[[nodiscard]] std::vector<double> volumeDepthOf(const harmonic::Annulus& annulus,
                                                const harmonic::Interpolant& interpolant,
                                                const Correspondence& correspondence);

/// Layer of each tissue voxel, 1 to `layers`; 0 where the depth is NaN.
/// @throws InvalidInput  fewer than one layer
[[nodiscard]] std::vector<int> layersOf(const std::vector<double>& depth, int layers);

}  // namespace explica::correspondence
