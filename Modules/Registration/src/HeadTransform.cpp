// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/HeadTransform.h"

#include "Explica/Core/VoxelSets.h"
#include "Filters.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace explica::registration {
namespace {

Vector displacementAt(const Volume<Eigen::Vector3f>& field, const Point& at) {
  const Grid& grid = field.grid;
  const Vector index = grid.toIndex(at);
  int low[3], high[3];
  float share[3];
  for (int a = 0; a < 3; ++a) {
    const double x = std::clamp(index[a], 0.0, grid.size[a] - 1.0);
    low[a] = static_cast<int>(x);
    high[a] = std::min(low[a] + 1, grid.size[a] - 1);
    share[a] = static_cast<float>(x - low[a]);
  }
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int c = 0; c < 8; ++c) {
    const float weight = ((c & 1) != 0 ? share[0] : 1 - share[0]) *
                         ((c & 2) != 0 ? share[1] : 1 - share[1]) *
                         ((c & 4) != 0 ? share[2] : 1 - share[2]);
    sum += weight * field((c & 1) != 0 ? high[0] : low[0], (c & 2) != 0 ? high[1] : low[1],
                          (c & 4) != 0 ? high[2] : low[2]);
  }
  return sum.cast<double>();
}

}  // namespace

double stretchOf(const Eigen::Affine3d& affine) {
  const Eigen::Vector3d stretches =
      Eigen::JacobiSVD<Eigen::Matrix3d>(affine.linear()).singularValues();
  return stretches[0] / stretches[2];
}

double turnOf(const Eigen::Affine3d& affine) {
  return Eigen::AngleAxisd(affine.rotation()).angle() * 180 / kPi;
}

Point HeadTransform::operator()(const Point& inImage) const {
  if (displacement.size() == 0) return affine * inImage;
  return affine * (inImage + displacementAt(displacement, inImage));
}

Volume<float> pulled(const Volume<float>& inTemplate, const HeadTransform& transform,
                     const Grid& grid) {
  return volumeBy(grid, [&](const Vector& index) {
    return valueAt(inTemplate, inTemplate.grid.toIndex(transform(grid.toWorld(index))));
  });
}

Volume<Label> pulled(const Volume<Label>& inTemplate, const HeadTransform& transform,
                     const Grid& grid) {
  Volume<Label> result(grid, 0);
  forLattice(grid, [&](int i, int j, int k) {
    const std::int64_t from = voxelAt(inTemplate.grid, transform(grid.toWorld(Vector(i, j, k))));
    if (from >= 0) result(i, j, k) = inTemplate[from];
  });
  return result;
}

}  // namespace explica::registration
