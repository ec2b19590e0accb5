// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Mosaic.h"

#include "Explica/Core/Errors.h"
#include "Explica/Report/Figure.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace explica::report {
namespace {

constexpr double kOffLattice = 1e-4;  // mm: no plane runs along a surface's faces

/// What a mosaic shows, and the box of the world that each tile frames.
struct Extent {
  WorldBox shown;   ///< over which the slices are spaced
  WorldBox framed;  ///< what a tile holds
};

Extent extentOf(const WorldBox& tissue, const std::vector<MosaicOutline>& outlines) {
  WorldBox lines;
  for (const MosaicOutline& outline : outlines) {
    if (outline.mesh->vertexCount() == 0) continue;
    lines.low = lines.low.cwiseMin(outline.mesh->positions.colwise().minCoeff().transpose());
    lines.high = lines.high.cwiseMax(outline.mesh->positions.colwise().maxCoeff().transpose());
  }
  if (lines.empty() && tissue.empty()) {
    throw InvalidInput("volume: every voxel is 0 or less; there is nothing to show");
  }
  return {lines.empty() ? tissue : lines, tissue.empty() ? lines : tissue};
}

/// Black below 0, white at the brightest but for the last half per cent.
ColourScale greyScale(const Volume<float>& image) {
  std::vector<float> values;
  for (const float v : image.data) {
    if (v > 0 && std::isfinite(v)) values.push_back(v);
  }
  ColourScale grey{ColourMap::Grey, 0, 1, "", ""};
  if (values.empty()) return grey;
  const auto bright = values.end() - 1 - static_cast<std::ptrdiff_t>(values.size() / 200);
  std::nth_element(values.begin(), bright, values.end());
  grey.high = 1.05 * *bright;
  return grey;
}

std::string pathData(const TriangleMesh& mesh, const SliceFrame& frame) {
  std::string path;
  std::array<char, 40> text{};
  for (const auto& line : cutPolylines(mesh, frame)) {
    char command = 'M';
    for (const Eigen::Vector2d& p : line) {
      std::snprintf(text.data(), text.size(), "%c%.1f %.1f", command, p.x(), p.y());
      path += text.data();
      command = 'L';
    }
  }
  return path;
}

SliceMosaic mosaicOf(const Extent& extent, const std::vector<MosaicOutline>& outlines,
                     const MosaicOptions& options,
                     const std::function<Picture(const SliceFrame&)>& render) {
  if (options.perRow <= 0) throw InvalidInput("perRow: must be positive");
  if (options.tileHeight <= 0) throw InvalidInput("tileHeight: must be positive");
  SliceMosaic mosaic;
  mosaic.convention = options.convention;
  for (const MosaicOutline& outline : outlines) {
    mosaic.outlines.emplace_back(outline.name, outline.colour);
  }
  for (const SliceAxis axis : {SliceAxis::Axial, SliceAxis::Coronal, SliceAxis::Sagittal}) {
    const int normal = axis == SliceAxis::Sagittal ? 0 : (axis == SliceAxis::Coronal ? 1 : 2);
    std::vector<MosaicTile> row;
    for (int s = 0; s < options.perRow; ++s) {
      const double share = (s + 1.0) / (options.perRow + 1.0);
      const double at =
          extent.shown.low[normal] + share * (extent.shown.high[normal] - extent.shown.low[normal]);
      SliceFrame frame = frameAround(axis, at + kOffLattice, extent.framed.low, extent.framed.high,
                                     options.tileHeight);
      frame.leftOnRight = options.convention == SideConvention::Radiological;
      MosaicTile tile;
      tile.place = std::string(1, "xyz"[normal]) + " = " +
                   std::to_string(static_cast<int>(std::lround(at))) + " mm";
      const auto letters = directionLetters(frame);
      for (int l = 0; l < 4; ++l) tile.letters[l] = std::string(1, letters[l]);
      tile.picture = render(frame);
      for (const MosaicOutline& outline : outlines) {
        tile.paths.push_back(pathData(*outline.mesh, frame));
      }
      row.push_back(std::move(tile));
    }
    mosaic.rows.push_back(std::move(row));
  }
  return mosaic;
}

}  // namespace

SliceMosaic makeMosaic(const Volume<float>& image, const std::vector<MosaicOutline>& outlines,
                       const MosaicOptions& options) {
  const ColourScale grey = greyScale(image);
  return mosaicOf(extentOf(boxAbove(image, 0), outlines), outlines, options,
                  [&](const SliceFrame& frame) { return renderSlice(image, frame, grey); });
}

std::array<SliceMosaic, 2> makeMosaics(const Volume<float>& before, const Volume<float>& after,
                                       const MosaicOptions& options) {
  if (before.grid.size != after.grid.size) {
    throw InvalidInput("after: is of another size than before");
  }
  Extent extent{boxAbove(after, 0), boxAbove(before, 0)};
  if (extent.shown.empty() || extent.framed.empty()) {
    throw InvalidInput("volume: every voxel is 0 or less; there is nothing to show");
  }
  const ColourScale grey = greyScale(after);
  const auto of = [&](const Volume<float>& image) {
    return mosaicOf(extent, {}, options,
                    [&](const SliceFrame& frame) { return renderSlice(image, frame, grey); });
  };
  return {of(before), of(after)};
}

SliceMosaic makeMosaic(const Volume<Label>& labels, const MosaicOptions& options) {
  Volume<float> tissue(labels.grid, 0.0f);
  for (std::size_t v = 0; v < labels.size(); ++v) tissue[v] = labels[v] != 0 ? 1.0f : 0.0f;
  return mosaicOf(extentOf(boxAbove(tissue, 0), {}), {}, options,
                  [&](const SliceFrame& frame) { return renderLabelSlice(labels, frame); });
}

}  // namespace explica::report
