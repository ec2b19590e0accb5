// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Phantom/Cortex.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/Fixtures.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace explica::phantom {
namespace {

constexpr int kSubdivisions = 5;  // 20,480 faces
constexpr double kFluid = 3;      // mm beyond the ribbon
constexpr double kWhiteLeft = 3;  // mm at least between ventricle and ribbon
constexpr double kMargin = 3;     // voxels to the grid's edge

/// Distance from the surface, negative inside.  The mesh is fine beside its folds, so that the
/// normal of the nearest face tells the side.
double signedDistance(const geometry::FaceTree& tree, const Point& p) {
  const geometry::ClosestPoint nearest = tree.closestPoint(p);
  const TriangleMesh& mesh = tree.mesh();
  const Vector ab = mesh.corner(nearest.face, 1) - mesh.corner(nearest.face, 0);
  const Vector ac = mesh.corner(nearest.face, 2) - mesh.corner(nearest.face, 0);
  const Vector away = p - nearest.point;
  const double side = ab.y() * ac.z() * away.x() - ab.z() * ac.y() * away.x() +
                      ab.z() * ac.x() * away.y() - ab.x() * ac.z() * away.y() +
                      ab.x() * ac.y() * away.z() - ab.y() * ac.x() * away.z();
  return std::copysign(std::sqrt(nearest.squaredDistance), side);
}

}  // namespace

Cortex makeCortex(const CortexOptions& o) {
  if (o.size < 32) throw InvalidInput("size: must be 32 or more");
  if (!(o.spacing > 0)) throw InvalidInput("spacing: must be above 0 mm");
  if (!(o.depth >= 0 && o.depth <= 0.5)) throw InvalidInput("depth: must lie in 0 to 0.5");
  if (o.waves < 1) throw InvalidInput("waves: must be 1 or more");
  if (!(o.noise >= 0)) throw InvalidInput("noise: must be 0 or more");
  if (!(o.dura >= 0)) throw InvalidInput("dura: must be 0 mm or more");
  if (!(o.duraGap > 0) || o.duraGap + o.dura > kFluid) {
    throw InvalidInput(
        "dura-gap: must be above 0 mm, and with the sheet itself at most the 3 mm of fluid");
  }
  const double radius = 0.5 * o.size * o.spacing - o.thickness - kFluid - kMargin * o.spacing;
  if (!(o.thickness > 0) || !(radius > 2 * o.thickness)) {
    throw InvalidInput("thickness: must be above 0 mm and leave room for white matter in the grid");
  }

  if (!(o.ventricle >= 0) ||
      (o.ventricle > 0 && o.ventricle + kWhiteLeft > radius * (1 - o.depth))) {
    throw InvalidInput("ventricle: must be 0 mm or more and leave 3 mm of white matter");
  }

  Grid grid;
  grid.size = {o.size, o.size, o.size};
  grid.spacing = Vector::Constant(o.spacing);
  grid.origin = Point::Constant(-0.5 * (o.size - 1) * o.spacing);
  Cortex cortex;
  cortex.thickness = o.thickness;
  cortex.white = geometry::makeFoldedSphere(kSubdivisions, radius, o.depth, o.waves);
  cortex.labels = Volume<Label>(grid, Cortex::kOutside);
  cortex.level = Volume<float>(grid, 0.0f);
  cortex.image = Volume<float>(grid, 0.0f);
  const geometry::FaceTree tree(cortex.white);
  parallelFor(grid.voxelCount(), 1024, [&](std::size_t v) {
    const auto [i, j, k] = grid.subscripts(v);
    cortex.level[v] = static_cast<float>(signedDistance(tree, grid.toWorld(Vector(i, j, k))));
  });

  // One stream in voxel order, so that the image does not depend on the number of threads.
  std::mt19937 generator(static_cast<std::uint32_t>(o.seed));
  std::normal_distribution<double> gauss(0, 1);
  const auto share = [&](double inside) { return std::clamp(0.5 + inside / o.spacing, 0.0, 1.0); };
  for (std::size_t v = 0; v < cortex.level.size(); ++v) {
    const double d = cortex.level[v];
    if (d > o.thickness + kFluid) continue;
    cortex.labels[v] = d <= 0 ? Cortex::kWhite : (d <= o.thickness ? Cortex::kGrey : Cortex::kCsf);
    const auto [i, j, k] = grid.subscripts(v);
    const Point at = grid.toWorld(Vector(i, j, k));
    const double lake = o.ventricle > 0 ? share(o.ventricle - at.norm()) : 0;
    if (lake > 0.5) cortex.labels[v] = Cortex::kCsf;
    const double white = share(-d) - lake;
    const double grey = share(o.thickness - d) - share(-d);
    const double sheet = o.thickness + o.duraGap;
    const double dura = o.dura > 0 ? share(sheet + o.dura - d) - share(sheet - d) : 0;
    const double clean = 115 * white + 85 * grey + 70 * dura + 35 * (1 - white - grey - dura);
    const double x = at.x() / (0.5 * o.size * o.spacing);
    cortex.image[v] =
        static_cast<float>(std::max(1.0, (clean + o.noise * gauss(generator)) * (1 + o.bias * x)));
  }
  return cortex;
}

}  // namespace explica::phantom
