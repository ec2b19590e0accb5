// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ColumnMeasures.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Surface/LevelSet.h"

#include <cmath>
#include <vector>

namespace explica::surface {

Eigen::VectorXd thicknessAtVertices(const harmonic::Annulus& annulus,
                                    const correspondence::Correspondence& found,
                                    const TriangleMesh& middle) {
  // A quarter of the value at the centre and three quarters of those on a circle of sqrt(2/3) of
  // the radius are the mean over a disc, exact to the third degree.
  const double radius = voxelSize(annulus.grid) / std::sqrt(kPi);
  const double off = std::sqrt(2.0 / 3) * radius;
  const auto topology = geometry::buildTopology(middle.faces, middle.vertexCount());
  Eigen::VectorXd thickness(middle.vertexCount());
  parallelFor(static_cast<std::size_t>(thickness.size()), 512, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Point here = middle.positions.row(row);
    const auto centre = correspondence::thicknessAt(annulus, found, here);
    thickness[row] = centre.value_or(kNaN);
    double sum = 0, count = 0;
    for (const std::int32_t w : topology.vertexVertices[v]) {
      const Vector way = middle.positions.row(w).transpose() - here;
      const auto beside =
          correspondence::thicknessAt(annulus, found, here + off * way.normalized());
      if (beside) sum += *beside, count += 1;
    }
    if (centre && count > 0) thickness[row] = 0.25 * *centre + 0.75 * sum / count;
  });
  return thickness;
}

Columns columnsAround(const harmonic::Annulus& annulus, const correspondence::Correspondence& found,
                      const TriangleMesh& middle) {
  const geometry::FaceTree tree(middle);
  std::vector<std::int32_t> nearest(annulus.count());
  parallelForBlocks(nearest.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::int32_t face = 0;  // of the voxel before
    for (std::size_t n = begin; n < end; ++n) {
      const Point x = annulus.world(static_cast<std::int32_t>(n));
      face = tree.closestPoint(x, face).face;
      int corner = 0;
      for (int c = 1; c < 3; ++c) {
        if ((middle.corner(face, c) - x).squaredNorm() <
            (middle.corner(face, corner) - x).squaredNorm()) {
          corner = c;
        }
      }
      nearest[n] = middle.faces(face, corner);
    }
  });
  Columns columns;
  columns.area = columns.thickness = Eigen::VectorXd::Zero(middle.vertexCount());
  const double volume = annulus.grid.voxelVolume();
  for (std::size_t n = 0; n < nearest.size(); ++n) {
    const double area = volume * correspondence::columnWeight(found, n);
    if (!(area > 0)) continue;
    columns.area[nearest[n]] += area;
    columns.thickness[nearest[n]] += area * found.thickness(n);
  }
  columns.thickness =
      (columns.area.array() > 0).select(columns.thickness.array() / columns.area.array(), 0.0);
  return columns;
}

}  // namespace explica::surface
