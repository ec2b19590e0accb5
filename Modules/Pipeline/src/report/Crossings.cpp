// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "CloseUps.h"
#include "Explica/Core/Folders.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/SurfaceFile.h"
#include "ReportParts.h"

#include <algorithm>

namespace explica::pipeline {
namespace {

/// Whether the pair's place is on both of its faces: else the surface is another one, or in another
/// frame, than that of the list.
bool liesOn(const TriangleMesh& mesh, const CrossingPair& pair) {
  constexpr double kRounding = 1e-3;  // mm; the list has four decimals
  return std::ranges::all_of(pair.faces, [&](std::int32_t f) {
    if (f >= mesh.faceCount()) return false;
    Point low = mesh.corner(f, 0), high = low;
    for (int c = 1; c < 3; ++c) {
      low = low.cwiseMin(Point(mesh.corner(f, c)));
      high = high.cwiseMax(Point(mesh.corner(f, c)));
    }
    return (pair.place.array() >= low.array() - kRounding).all() &&
           (pair.place.array() <= high.array() + kRounding).all();
  });
}

/// An image with nothing on it, under outlines alone.
Volume<float> blank() {
  Grid grid;
  grid.size = {1, 1, 1};
  return Volume<float>(grid, 0.0F);
}

}  // namespace

void showCrossings(ResultFolder& results, const StepFolder& step,
                   const FolderReportOptions& options) {
  constexpr double kEdges = 9;  // a tile's side in mean edges of the surface
  auto& mosaics = results.content().mosaics;
  const std::vector<CrossingPair> pairs = crossingPairs(step);
  const auto source = inputOf(step, "SURFACE");
  if (pairs.empty() || !source || !isThere(*source)) return;
  const bool shown =
      std::ranges::any_of(mosaics, [](const auto& mosaic) { return mosaic.id == kCrossingPlace; });
  if (shown) return;
  const TriangleMesh mesh = io::readSurface(*source).mesh;
  std::vector<std::int32_t> faces;
  for (const CrossingPair& pair : pairs) {
    if (!liesOn(mesh, pair)) return;
    faces.insert(faces.end(), pair.faces.begin(), pair.faces.end());
  }
  std::ranges::sort(faces);
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  const TriangleMesh crossing = geometry::extractFaces(mesh, faces).mesh;
  report::MosaicOptions close{.tileHeight = 170, .convention = options.convention};
  mosaics.push_back(
      {kCrossingPlace, "Where faces cross" + step.sideWords(),
       "Slices through the surface as it was at the start; every pair is listed in "
       "intersections.tsv.",
       report::makeCloseUps(
           blank(), {{&mesh, "surface", "#ffd60a"}, {&crossing, "faces that cross", "#ff453a"}},
           crossingPlaces(pairs, kMostPlaces), kEdges * geometry::meanEdgeLength(mesh), close)});
}

}  // namespace explica::pipeline
