// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/SliceStack.h"

#include "Encoding.h"
#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Report/Figure.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace explica::report {
namespace {

constexpr double kAround = 10;        // mm around the outlines
constexpr double kMostVoxels = 12e6;  // about 8 MB in a page

/// Points low + step (i, j, k).
struct Lattice {
  Point low = Point::Zero();
  double step = 1;
  std::array<int, 3> size{};
};

Lattice latticeOf(const Grid& grid, const std::vector<MosaicOutline>& outlines) {
  Eigen::AlignedBox3d box;
  for (const MosaicOutline& outline : outlines) box.extend(boundingBox(outline.mesh->positions));
  if (box.isEmpty()) throw InvalidInput("outlines: none has vertices");
  const Vector extent = box.sizes() + Vector::Constant(2 * kAround);
  Lattice lattice;
  lattice.step = std::max(grid.spacing.minCoeff(), std::cbrt(extent.prod() / kMostVoxels));
  const Point first = grid.toWorld(Vector::Zero());
  for (int a = 0; a < 3; ++a) {
    const double steps = std::ceil((box.min()[a] - kAround - first[a]) / lattice.step);
    lattice.low[a] = first[a] + lattice.step * steps;
    lattice.size[a] = 1 + static_cast<int>(extent[a] / lattice.step);
  }
  return lattice;
}

/// Grey of each point, x fastest, then y, then z.
std::vector<std::int32_t> greyOf(const Volume<float>& image, const Lattice& lattice,
                                 const ColourScale& scale) {
  SliceFrame frame{.axis = SliceAxis::Axial,
                   .pixel = lattice.step,
                   .width = lattice.size[0],
                   .height = lattice.size[1]};
  for (int a = 0; a < 2; ++a) {
    frame.centre[a] = lattice.low[a] + 0.5 * (lattice.size[a] - 1) * lattice.step;
  }
  std::vector<std::int32_t> grey;
  for (int k = 0; k < lattice.size[2]; ++k) {
    frame.position = lattice.low[2] + k * lattice.step;
    const Picture slice = renderSlice(image, frame, scale);
    for (int y = slice.height - 1; y >= 0; --y) {
      for (int x = 0; x < slice.width; ++x) grey.push_back(slice.pixel(x, y)[0]);
    }
  }
  return grey;
}

}  // namespace

std::string sliceStackJson(const Volume<float>& image, const std::vector<MosaicOutline>& outlines,
                           const std::vector<CloseUp>& places, const MosaicOptions& options) {
  const Lattice lattice = latticeOf(image.grid, outlines);
  nlohmann::json listed = nlohmann::json::array();
  for (const CloseUp& place : places) {
    listed.push_back(
        {{"words", place.words}, {"at", {place.place.x(), place.place.y(), place.place.z()}}});
  }
  nlohmann::json surfaces = nlohmann::json::array();
  for (const MosaicOutline& outline : outlines) {
    surfaces.push_back(
        {{"part", outline.part}, {"shape", outline.shape}, {"colour", outline.colour}});
  }
  const nlohmann::json head = {{"low", {lattice.low.x(), lattice.low.y(), lattice.low.z()}},
                               {"voxel", lattice.step},
                               {"size", lattice.size},
                               {"surfaces", surfaces},
                               {"leftOnRight", options.convention == SideConvention::Radiological},
                               {"places", listed}};
  nlohmann::ordered_json json = head;
  json["grey"] = packIntegers(greyOf(image, lattice, greyScale(image, options.subject)), 1);
  return json.dump();
}

}  // namespace explica::report
