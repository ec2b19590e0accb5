// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/SurfaceFile.h"

#include <Eigen/Geometry>

namespace explica::io {

std::string structureFromName(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const auto has = [&name](const char* word) { return name.find(word) != std::string::npos; };
  if (name.starts_with("lh.") || has("hemi-L") || has("_left.") || has(".L.") || has("_lh.")) {
    return "CortexLeft";
  }
  if (name.starts_with("rh.") || has("hemi-R") || has("_right.") || has(".R.") || has("_rh.")) {
    return "CortexRight";
  }
  return "Other";
}

Eigen::Matrix4d scannerFromTkr(const Grid& volume) {
  // FreeSurfer's Torig: the conformed axes x = -i, y = +k, z = -j about the middle voxel n/2.
  const Vector& h = volume.spacing;
  Eigen::Matrix4d torig = Eigen::Matrix4d::Zero();
  torig.row(0) << -h[0], 0, 0, 0.5 * h[0] * volume.size[0];
  torig.row(1) << 0, 0, h[2], -0.5 * h[2] * volume.size[2];
  torig.row(2) << 0, -h[1], 0, 0.5 * h[1] * volume.size[1];
  torig(3, 3) = 1;
  return volume.affine() * torig.inverse();
}

}  // namespace explica::io
