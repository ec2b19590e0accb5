// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ColumnMeasures.h"

#include "Explica/Core/Parallel.h"
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

Columns columnsOf(const harmonic::Annulus& annulus, const correspondence::Correspondence& found,
                  const std::vector<std::uint8_t>& leftOut) {
  std::vector<std::int32_t> known;
  for (std::size_t n = 0; n < annulus.count(); ++n) {
    if (!leftOut.empty() && leftOut[n]) continue;
    if (correspondence::columnWeight(found, n) > 0) known.push_back(static_cast<std::int32_t>(n));
  }
  const auto count = static_cast<Eigen::Index>(known.size());
  Columns columns{Positions(count, 3), Positions(count, 3), Eigen::VectorXd(count),
                  Eigen::VectorXd(count)};
  const double volume = annulus.grid.voxelVolume();
  parallelFor(known.size(), 4096, [&](std::size_t c) {
    const auto row = static_cast<Eigen::Index>(c);
    const std::int32_t n = known[c];
    const Point centre = annulus.world(n);
    columns.inner.row(row) = centre + found.innerPoint[n].cast<double>();
    columns.outer.row(row) = centre + found.outerPoint[n].cast<double>();
    columns.area[row] = volume * correspondence::columnWeight(found, n);
    columns.thickness[row] = found.thickness(n);
  });
  return columns;
}

}  // namespace explica::surface
