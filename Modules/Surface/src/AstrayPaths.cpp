// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "AstrayPaths.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshTopology.h"
#include "PathProfile.h"

#include <utility>

namespace explica::surface {
namespace {

constexpr double kAstray = 1.3;    // of the median around
constexpr double kAstrayBy = 0.5;  // voxels

}  // namespace

std::int64_t shortenAstray(const TriangleMesh& white, double voxel,
                           std::vector<Trajectory>& paths) {
  const auto topology = geometry::buildTopology(white.faces, white.vertexCount());
  std::vector<double> most(paths.size(), kInfinity);
  parallelFor(paths.size(), 512, [&](std::size_t v) {
    std::vector<double> lengths;
    for (const std::int32_t w : withinTwoEdges(v, topology)) {
      if (paths[w].length() > 0) lengths.push_back(paths[w].length());
    }
    if (lengths.empty()) return;
    const double usual = median(std::move(lengths)), length = paths[v].length();
    if (length > kAstray * usual && length > usual + kAstrayBy * voxel) most[v] = usual;
  });
  std::int64_t shortened = 0;
  for (std::size_t v = 0; v < paths.size(); ++v) {
    if (most[v] == kInfinity) continue;
    paths[v] = between(paths[v], 0, most[v]);
    paths[v].end = TrajectoryEnd::Astray;
    ++shortened;
  }
  return shortened;
}

}  // namespace explica::surface
