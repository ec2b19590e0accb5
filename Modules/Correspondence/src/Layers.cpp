// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Layers.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"

#include <algorithm>
#include <cmath>

namespace explica::correspondence {

std::vector<double> depthOf(const Correspondence& correspondence) {
  std::vector<double> depth(correspondence.innerDistance.size());
  parallelFor(depth.size(), 1 << 14, [&](std::size_t n) {
    const double thickness = correspondence.thickness(n);
    depth[n] = thickness > 0 ? correspondence.innerDistance[n] / thickness : kNaN;
  });
  return depth;
}

std::vector<double> volumeDepthOf(const harmonic::Annulus& annulus,
                                  const harmonic::Interpolant& interpolant,
                                  const Correspondence& correspondence) {
  const TrajectoryTracer tracer(annulus, interpolant);
  const auto& field = tracer.field();
  std::vector<double> share(annulus.count());
  // Volume from a voxel to one boundary, relative to the bundle's flux.
  const auto volumeTo = [&](std::int32_t n, double target, int uphill) {
    auto walk = field.begin(annulus.place[n], uphill);
    const auto inverseSlope = [](const Vector& gradient, const Vector& inverseSpacing) {
      const double slope = gradient.cwiseProduct(inverseSpacing).norm();
      return slope > 0 ? 1 / slope : 0.0;
    };
    double here = inverseSlope(field.sample(walk.x, walk.home).gradient, field.inverseSpacing);
    double sum = 0;
    bool done = uphill * (walk.u - target) >= 0;
    for (int k = 0; !done && !walk.stuck && k < 4000; ++k) {
      const Vector from = walk.x;
      const double before = walk.length;
      done = field.advance(walk, target, uphill);
      const double middle = inverseSlope(field.sample(0.5 * (from + walk.x), walk.home).gradient,
                                         field.inverseSpacing);
      const double there =
          inverseSlope(field.sample(walk.x, walk.home).gradient, field.inverseSpacing);
      sum += (walk.length - before) / 6 * (here + 4 * middle + there);
      here = there;
    }
    return sum;
  };
  parallelFor(annulus.count(), 512, [&](std::size_t index) {
    const auto n = static_cast<std::int32_t>(index);
    share[n] = kNaN;
    if (std::isnan(correspondence.thickness(n))) return;
    const double below = volumeTo(n, 0, -1), above = volumeTo(n, 1, 1);
    if (below + above > 0) share[n] = below / (below + above);
  });
  return share;
}

std::vector<int> layersOf(const std::vector<double>& depth, int layers) {
  if (layers < 1) throw InvalidInput("there must be at least one layer");
  std::vector<int> layer(depth.size());
  parallelFor(depth.size(), 1 << 14, [&](std::size_t n) {
    layer[n] =
        std::isnan(depth[n]) ? 0 : std::clamp(static_cast<int>(depth[n] * layers) + 1, 1, layers);
  });
  return layer;
}

}  // namespace explica::correspondence
