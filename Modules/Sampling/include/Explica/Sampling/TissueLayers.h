// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"
#include "Explica/Sampling/Statistics.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace explica::sampling {

/// Voxels of a tissue between two boundaries and where they lie on their trajectories.
struct TissueVoxels {
  Grid grid;
  std::vector<std::size_t> voxels;     ///< in storage order
  std::vector<float> depth;            ///< L0 / (L0 + L1), per entry of `voxels`
  std::vector<float> thickness;        ///< L0 + L1, mm
  std::vector<Eigen::Vector3f> along;  ///< unit direction from inner to outer boundary, RAS
};

/// The tissue of a thickness measurement: voxels whose thickness is known.
/// @param innerPoint, outerPoint  ends of each voxel's trajectory, RAS mm
/// @throws InvalidInput  volumes on different grids, or no voxel with a thickness
[[nodiscard]] TissueVoxels tissueOf(const Volume<float>& thickness, const Volume<float>& depth,
                                    const Volume<Eigen::Vector3f>& innerPoint,
                                    const Volume<Eigen::Vector3f>& outerPoint);

/// How each voxel's volume is shared among layers.  A voxel's shares add up to 1.
struct LayerShares {
  int layers = 0;
  std::vector<std::size_t> begin;     ///< per tissue voxel, one more than there are
  std::vector<std::int32_t> layerOf;  ///< from 0 at the inner boundary
  std::vector<float> share;
};

/// Layers of equal share of the thickness, of finer extent than voxels: the depth changes by
/// 1 / thickness a millimetre along the trajectory, so that planes of equal depth cut the voxel.
/// Shares are those of 5 x 5 x 5 points of it.
[[nodiscard]] LayerShares layersByDepth(const TissueVoxels& tissue, int layers);

/// Layers as a label volume has them, whole voxels, from 1 at the inner boundary; voxels of layer 0
/// belong to none.
/// @throws InvalidInput  another grid, a negative layer, or no layer
[[nodiscard]] LayerShares layersOfVolume(const TissueVoxels& tissue, const Volume<Label>& layers);

/// A map's values in one layer of one region.
struct LayerRow {
  std::string region;
  int layer = 0;             ///< from 1 at the inner boundary
  double mean = kNaN;        ///< each cubic millimetre counts the same
  double deviation = kNaN;   ///< of voxels, weighted alike
  std::size_t count = 0;     ///< voxels with a share in it
  double volume = 0;         ///< of what is known, mm^3: mean times volume adds up to the integral
  double columnMean = kNaN;  ///< each column counts the same: weights 1 / thickness
};

/// Table of layers by region.  Voxels whose value is not known count nowhere.
/// @param values   one per tissue voxel; NaN: not known
/// @param regions  of the tissue voxels
[[nodiscard]] std::vector<LayerRow> layerTable(const TissueVoxels& tissue,
                                               const LayerShares& shares,
                                               std::span<const float> values,
                                               std::span<const std::int32_t> regionOf,
                                               const std::vector<std::string>& regionNames);

}  // namespace explica::sampling
