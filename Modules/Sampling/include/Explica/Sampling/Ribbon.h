// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Sampling/Sampler.h"

#include <functional>
#include <span>
#include <vector>

namespace explica::sampling {

/// Means over the tissue about each vertex: over the volume between the white and the pial faces
/// that have the vertex, each cubic millimetre alike, as Workbench's ribbon mapping has it.  Beside
/// a column of points it averages sideways, too, by the length of the edges.
///
/// A face's prism is sampled at 4 places of each of 10 layers.  A vertex is known if at least half
/// of its volume is.
class RibbonSampler {
 public:
  /// @param white, pial  same faces; kept by reference
  /// @param toVolume     takes places of the surfaces to the world of `grid`
  /// @param mask         on the same grid: voxels that are 0 are not known; kept by reference
  /// @throws InvalidInput  surfaces that do not correspond
  RibbonSampler(const Grid& grid, const TriangleMesh& white, const TriangleMesh& pial,
                Interpolation interpolation = Interpolation::Linear,
                std::function<Positions(const Positions&)> toVolume = {},
                const Volume<std::uint8_t>* mask = nullptr);

  /// @param frames  F x voxels, frame after frame
  /// @return F x V, frame after frame; NaN where not known
  [[nodiscard]] std::vector<float> sample(std::span<const float> frames) const;

 private:
  Grid grid_;
  const TriangleMesh& white_;
  const TriangleMesh& pial_;
  Interpolation interpolation_;
  std::function<Positions(const Positions&)> toVolume_;
  const Volume<std::uint8_t>* mask_;
};

}  // namespace explica::sampling
