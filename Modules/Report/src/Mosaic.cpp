// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Mosaic.h"

#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Text.h"
#include "Explica/Report/Figure.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace explica::report {
namespace {

// One row of pictures each, from above to below.
constexpr std::array kAxes = {SliceAxis::Axial, SliceAxis::Coronal, SliceAxis::Sagittal};
constexpr double kOffLattice = 1e-4;  // mm: no plane runs along a surface's faces

/// What a mosaic shows, and the box of the world that each tile frames.
struct Extent {
  Eigen::AlignedBox3d shown;   ///< over which the slices are spaced
  Eigen::AlignedBox3d framed;  ///< what a tile holds
};

Extent extentOf(const Eigen::AlignedBox3d& tissue, const std::vector<MosaicOutline>& outlines) {
  Eigen::AlignedBox3d lines;
  for (const MosaicOutline& outline : outlines) lines.extend(boundingBox(outline.mesh->positions));
  if (lines.isEmpty() && tissue.isEmpty()) {
    throw InvalidInput("volume: every voxel is 0 or less; there is nothing to show");
  }
  return {lines.isEmpty() ? tissue : lines, tissue.isEmpty() ? lines : tissue};
}

/// Of a line's points those that lie apart by what can be seen, and its ends; from one to the next
/// in tenths of a pixel, since pages hold hundreds of such lines.
std::string pathData(const TriangleMesh& mesh, const SliceFrame& frame) {
  constexpr double kSeen = 1.1;  // pixels
  std::string path;
  for (const auto& line : cutPolylines(mesh, frame)) {
    Eigen::Vector2i last(0, 0);  // tenths of a pixel
    for (std::size_t n = 0; n < line.size(); ++n) {
      const Eigen::Vector2i at = (10 * line[n]).array().round().cast<int>();
      const bool seen = (at - last).cast<double>().norm() >= 10 * kSeen;
      if (n > 0 && n + 1 < line.size() && !seen) continue;
      const Eigen::Vector2i by = n == 0 ? at : Eigen::Vector2i(at - last);
      path += printed("%c%g %g", n == 0 ? 'M' : 'l', 0.1 * by.x(), 0.1 * by.y());
      last = at;
    }
  }
  return path;
}

using RenderSlice = std::function<Picture(const SliceFrame&)>;

int normalOf(SliceAxis axis) {
  return axis == SliceAxis::Sagittal ? 0 : (axis == SliceAxis::Coronal ? 1 : 2);
}

std::string placeWords(SliceAxis axis, double at) {
  return std::string(1, "xyz"[normalOf(axis)]) + " = " +
         std::to_string(static_cast<int>(std::lround(at))) + " mm";
}

MosaicTile tileOf(const SliceFrame& frame, const std::vector<MosaicOutline>& outlines,
                  const RenderSlice& render) {
  MosaicTile tile;
  const auto letters = directionLetters(frame);
  for (int l = 0; l < 4; ++l) tile.letters[l] = std::string(1, letters[l]);
  tile.picture = render(frame);
  for (const MosaicOutline& outline : outlines) {
    tile.paths.push_back(pathData(*outline.mesh, frame));
  }
  return tile;
}

SliceMosaic emptyMosaic(const std::vector<MosaicOutline>& outlines, const MosaicOptions& options) {
  if (options.perRow <= 0) throw InvalidInput("perRow: must be positive");
  if (options.tileHeight <= 0) throw InvalidInput("tileHeight: must be positive");
  SliceMosaic mosaic;
  mosaic.convention = options.convention;
  for (const MosaicOutline& outline : outlines) {
    mosaic.outlines.emplace_back(outline.name, outline.colour);
  }
  return mosaic;
}

/// The faces of a mesh that reach into a box.
TriangleMesh partWithin(const TriangleMesh& mesh, const Point& low, const Point& high) {
  TriangleMesh part{mesh.positions, Faces(mesh.faceCount(), 3)};
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Point a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
    const bool apart = (a.cwiseMin(b).cwiseMin(c).array() > high.array()).any() ||
                       (a.cwiseMax(b).cwiseMax(c).array() < low.array()).any();
    if (!apart) part.faces.row(count++) = mesh.faces.row(f);
  }
  part.faces.conservativeResize(count, 3);
  return part;
}

/// A ring about the middle of a picture, as SVG path data.
std::string ringPath(const Picture& picture, double radius) {
  const double x = 0.5 * picture.width, y = 0.5 * picture.height;
  return printed("M%.1f %.1fa%.1f %.1f 0 1 0 %.1f 0a%.1f %.1f 0 1 0 %.1f 0", x - radius, y, radius,
                 radius, 2 * radius, radius, radius, -2 * radius);
}

SliceMosaic mosaicOf(const Extent& extent, const std::vector<MosaicOutline>& outlines,
                     const MosaicOptions& options, const RenderSlice& render) {
  SliceMosaic mosaic = emptyMosaic(outlines, options);
  for (const SliceAxis axis : kAxes) {
    const int normal = normalOf(axis);
    std::vector<MosaicTile> row;
    for (int s = 0; s < options.perRow; ++s) {
      const double share = (s + 1.0) / (options.perRow + 1.0);
      const double low = extent.shown.min()[normal];
      const double at = low + share * (extent.shown.max()[normal] - low);
      SliceFrame frame = frameAround(axis, at + kOffLattice, extent.framed.min(),
                                     extent.framed.max(), options.tileHeight);
      frame.leftOnRight = options.convention == SideConvention::Radiological;
      MosaicTile tile = tileOf(frame, outlines, render);
      tile.place = placeWords(axis, at);
      row.push_back(std::move(tile));
    }
    mosaic.rows.push_back(std::move(row));
  }
  return mosaic;
}

}  // namespace

ColourScale greyScale(const Volume<float>& image, const Volume<float>* subject) {
  if (subject && subject->grid.size != image.grid.size) {
    throw InvalidInput("subject: is of another size than the image");
  }
  std::vector<float> values;
  for (std::size_t n = 0; n < image.size(); ++n) {
    const float v = image[n];
    if (v > 0 && std::isfinite(v) && (!subject || (*subject)[n] > 0)) values.push_back(v);
  }
  ColourScale grey{ColourMap::Grey, 0, 1, "", ""};
  if (values.empty()) return grey;
  grey.high = 1.05 * nthSmallest(values, values.size() - 1 - values.size() / 200);
  return grey;
}

SliceMosaic makeMosaic(const Volume<float>& image, const std::vector<MosaicOutline>& outlines,
                       const MosaicOptions& options) {
  const ColourScale grey = greyScale(image, options.subject);
  return mosaicOf(extentOf(boxAbove(image, 0), outlines), outlines, options,
                  [&](const SliceFrame& frame) { return renderSlice(image, frame, grey); });
}

Picture sliceFigure(const Volume<float>& image, const std::vector<Contour>& contours, int count,
                    int height) {
  std::vector<MosaicOutline> outlines;
  for (const Contour& contour : contours) outlines.push_back({contour.mesh, "", ""});
  const ColourScale grey = greyScale(image, nullptr);
  SliceMosaic mosaic =
      mosaicOf(extentOf(boxAbove(image, 0), outlines), {}, {.perRow = count, .tileHeight = height},
               [&](const SliceFrame& frame) { return renderSlice(image, frame, grey, contours); });
  std::vector<Picture> rows;
  int width = 0;
  for (std::vector<MosaicTile>& tiles : mosaic.rows) {
    std::vector<Picture> slices;
    for (MosaicTile& tile : tiles) {
      drawText(tile.picture, tile.place, {8, height - 8.0}, 9, {0.8f, 0.8f, 0.8f});
      slices.push_back(std::move(tile.picture));
    }
    rows.push_back(tilePictures(slices, count));
    width = std::max(width, rows.back().width);
  }
  Picture whole(width, height * static_cast<int>(rows.size()), {0, 0, 0});
  for (std::size_t r = 0; r < rows.size(); ++r) {
    pastePicture(whole, rows[r], (width - rows[r].width) / 2, static_cast<int>(r) * height);
  }
  return whole;
}

SliceMosaic makeCloseUps(const Volume<float>& image, const std::vector<MosaicOutline>& outlines,
                         const std::vector<CloseUp>& places, double width,
                         const MosaicOptions& options) {
  if (places.empty()) throw InvalidInput("places: none is given");
  if (!(width > 0)) throw InvalidInput("width: must be positive");
  constexpr double kRing = 0.12;  // of a tile's height
  const ColourScale grey = greyScale(image, options.subject);
  const RenderSlice render = [&](const SliceFrame& frame) {
    return renderSlice(image, frame, grey);
  };
  SliceMosaic mosaic = emptyMosaic(outlines, options);
  mosaic.outlines.emplace_back("the place", "#32d7ff");
  mosaic.rows.resize(kAxes.size());
  for (const CloseUp& closeUp : places) {
    const Point low = closeUp.place.array() - 0.5 * width;
    const Point high = closeUp.place.array() + 0.5 * width;
    std::vector<TriangleMesh> parts;
    for (const MosaicOutline& outline : outlines) {
      parts.push_back(partWithin(*outline.mesh, low, high));
    }
    std::vector<MosaicOutline> near = outlines;
    for (std::size_t n = 0; n < near.size(); ++n) near[n].mesh = &parts[n];
    for (std::size_t a = 0; a < kAxes.size(); ++a) {
      const double at = closeUp.place[normalOf(kAxes[a])];
      SliceFrame frame = frameAround(kAxes[a], at + kOffLattice, low, high, options.tileHeight);
      frame.leftOnRight = options.convention == SideConvention::Radiological;
      MosaicTile tile = tileOf(frame, near, render);
      tile.paths.push_back(ringPath(tile.picture, kRing * options.tileHeight));
      tile.place = placeWords(kAxes[a], at) + (a == 0 ? ": " + closeUp.words : "");
      mosaic.rows[a].push_back(std::move(tile));
    }
  }
  return mosaic;
}

std::array<SliceMosaic, 2> makeMosaics(const Volume<float>& before, const Volume<float>& after,
                                       const MosaicOptions& options) {
  if (before.grid.size != after.grid.size) {
    throw InvalidInput("after: is of another size than before");
  }
  Extent extent{boxAbove(after, 0), boxAbove(before, 0)};
  if (extent.shown.isEmpty() || extent.framed.isEmpty()) {
    throw InvalidInput("volume: every voxel is 0 or less; there is nothing to show");
  }
  const ColourScale grey = greyScale(after, options.subject);
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
