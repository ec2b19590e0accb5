// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace explica::pipeline {

/// Means over a region at one depth, frame by frame.
struct AtDepth {
  std::vector<double> mean, deviation;

  [[nodiscard]] double average() const;
  /// Root mean square of the deviations of the frames.
  [[nodiscard]] double spread() const;
};

/// A region's profile of one volume: by depth, 0 at the white surface and 1 at the pial.
struct DepthProfile {
  std::string region;  ///< "all": of everything
  std::map<double, AtDepth> depths;
  double count = 0;  ///< vertices or voxels, at most at one depth
};

/// What `explica sample` says of one volume, region by region in its table's order.
struct VolumeProfiles {
  std::string volume;
  std::string of;    ///< what is counted: "vertices" or "voxels"
  std::string file;  ///< the table's name
  std::vector<DepthProfile> regions;

  /// The profile of all; nullptr where there is none.
  [[nodiscard]] const DepthProfile* all() const;
  /// The others that have any vertex, the largest first, at most so many.
  [[nodiscard]] std::vector<const DepthProfile*> largest(std::size_t most) const;
};

/// Profiles in a folder of `explica sample`: of profiles.tsv and of every NAME_layers.tsv.
/// @throws IOError  a table without a first row
[[nodiscard]] std::vector<VolumeProfiles> readDepthProfiles(const std::filesystem::path& folder);

}  // namespace explica::pipeline
