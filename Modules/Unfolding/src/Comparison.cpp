// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Comparison.h"

#include "Explica/Core/StopScope.h"
#include "Explica/Flattening/Seen.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"

namespace explica::unfolding {
namespace {

SurfaceComparison compare(const TriangleMesh& reference, const TriangleMesh& after,
                          std::span<const std::int32_t> faces,
                          const flattening::DistancePairs& pairs) {
  using flattening::DistanceKind;
  SurfaceComparison found;
  found.distortion = measureDistortion(reference, after.positions, faces);
  const TriangleMesh whole{after.positions, reference.faces};
  const bool flat = flattening::isFlatMap(whole, faces);
  const auto kind = flat ? DistanceKind::Straight : DistanceKind::Surface;
  found.distances.local = flattening::distanceError(pairs.local, whole, faces, kind);
  found.distances.all = flattening::distanceError(pairs.all, whole, faces, kind);
  found.turnedOver = flattening::turnedOver(whole, faces);
  const TriangleMesh part = geometry::extractFaces(whole, faces).mesh;
  found.crossings = geometry::findSelfIntersections(part).size();
  found.seen = flattening::seenShare(part);
  return found;
}

}  // namespace

Comparison compareSurfaces(const TriangleMesh& reference, std::span<const TriangleMesh> surfaces,
                           std::span<const std::string> names, std::span<const std::int32_t> faces,
                           const flattening::DistanceOptions& options, const Monitor& monitor) {
  Comparison comparison;
  comparison.faces = faces.size();
  const auto pairs = flattening::drawPairs(reference, faces, options);
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    monitor.progress(static_cast<double>(n) / static_cast<double>(surfaces.size()), names[n]);
    try {
      comparison.surfaces.push_back(compare(reference, surfaces[n], faces, pairs));
    } catch (const Interrupted&) {
      if (n == 0) throw;
      break;
    }
    comparison.surfaces.back().name = names[n];
  }
  return comparison;
}

}  // namespace explica::unfolding
