// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "MaskBorder.h"

#include "Explica/Core/Volume.h"
#include "Explica/IO/VolumeFile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace explica::pipeline {
namespace {

constexpr double kCell = 2;  // mm: finer steps would only make the page heavier

/// Every so many voxels' label, so that cells are about as wide as the page needs.
Volume<Label> thinned(const Volume<Label>& labels) {
  std::array<int, 3> step;
  Grid grid = labels.grid;
  for (int a = 0; a < 3; ++a) {
    step[a] = std::max(1, static_cast<int>(std::lround(kCell / grid.spacing[a])));
    grid.size[a] = (grid.size[a] - 1) / step[a] + 1;
    grid.spacing[a] *= step[a];
  }
  Volume<Label> thin(grid, 0);
  for (std::size_t v = 0; v < thin.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    thin[v] = labels(i * step[0], j * step[1], k * step[2]);
  }
  return thin;
}

/// Cells' faces between what is labelled and what is not, two triangles each.
TriangleMesh borderOfCells(const Volume<Label>& labels) {
  std::vector<Point> corners;
  const Grid& grid = labels.grid;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = grid.subscripts(v);
    for (int axis = 0; axis < 3; ++axis) {
      auto next = at;
      if (++next[axis] >= grid.size[axis]) continue;
      if ((labels[v] != 0) == (labels(next[0], next[1], next[2]) != 0)) continue;
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      for (const auto& [p, q] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}) {
        Vector index(at[0], at[1], at[2]);
        index[axis] += 0.5;
        index[b] += 0.5 * p;
        index[c] += 0.5 * q;
        corners.push_back(grid.toWorld(index));
      }
    }
  }
  TriangleMesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(corners.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(corners.size() / 3), 3);
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    mesh.positions.row(row) = corners[n].transpose();
    mesh.faces(row / 3, row % 3) = static_cast<std::int32_t>(n);
  }
  return mesh;
}

}  // namespace

TriangleMesh borderOf(const std::filesystem::path& labels) {
  return borderOfCells(thinned(io::readLabels(labels).volume));
}

std::optional<Volume<float>> brainOf(const StepFolder& segment, const Grid& grid) {
  if (!segment.has("brain_mask.nii.gz")) return {};
  Volume<float> brain = io::readScalars(segment.folder / "brain_mask.nii.gz").volume;
  return brain.grid.size == grid.size ? std::optional(std::move(brain)) : std::nullopt;
}

}  // namespace explica::pipeline
