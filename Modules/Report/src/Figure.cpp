// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Figure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Report/Canvas.h"
#include "Explica/Report/Mosaic.h"

#include <algorithm>
#include <cmath>

namespace explica::report {
namespace {

constexpr float kPale = 0.72f;  // share of light grey in what lies off the region

/// Grey gyri and darker sulci beneath colours, or alone where there are none.
void shadeFolds(const SurfacePaint& paint, std::vector<Colour>& colours) {
  constexpr float kGyrus = 0.55F, kSulcusAlone = 0.65F, kSulcusBeneath = 0.25F;  // darkening
  const double typical =
      std::sqrt(paint.folding.squaredNorm() /
                static_cast<double>(std::max<Eigen::Index>(paint.folding.size(), 1)));
  const bool plain = colours.empty();
  if (plain) colours.resize(static_cast<std::size_t>(paint.folding.size()));
  for (Eigen::Index v = 0; v < paint.folding.size(); ++v) {
    const bool alone = plain || (paint.values.size() != 0 && std::isnan(paint.values[v]));
    if (alone) colours[v] = {kGyrus, kGyrus, kGyrus};
    const auto sulcus = static_cast<float>(
        std::clamp(0.5 + 0.5 * paint.folding[v] / std::max(typical, 1e-12), 0.0, 1.0));
    for (float& c : colours[v]) c *= 1 - (alone ? kSulcusAlone : kSulcusBeneath) * sulcus;
  }
}

template <class Values>
void requireLength(const Values& values, Eigen::Index vertexCount, const char* what) {
  if (values.size() != 0 && values.size() != vertexCount) {
    throw InvalidInput(std::string(what) + ": found " + std::to_string(values.size()) +
                       " values, expected one for each of the surface's " +
                       std::to_string(vertexCount) + " vertices");
  }
}

}  // namespace

std::vector<Colour> coloursOf(const SurfacePaint& paint, Eigen::Index vertexCount) {
  requireLength(paint.values, vertexCount, "map");
  requireLength(paint.labels, vertexCount, "labels");
  requireLength(paint.region, vertexCount, "region");
  requireLength(paint.folding, vertexCount, "folding");
  std::vector<Colour> colours;
  if (paint.values.size() != 0) {
    colours = coloursOf(paint.values, paint.scale);
  } else if (paint.labels.size() != 0) {
    for (const Label label : paint.labels) {
      const auto own = paint.labelColours.find(label);
      colours.push_back(own == paint.labelColours.end() ? colourOfLabel(label) : own->second);
    }
  }
  if (paint.folding.size() != 0) shadeFolds(paint, colours);
  if (paint.region.size() != 0 && !colours.empty()) {
    for (Eigen::Index v = 0; v < vertexCount; ++v) {
      if (paint.region[v] != 0) continue;
      for (float& c : colours[v]) c = (1 - kPale) * c + kPale * 0.62f;
    }
  }
  return colours;
}

Camera cameraOf(const Positions& places, const FigureView& view, int width, int height) {
  const Positions seen = view.focus.empty() ? places : Positions(places(view.focus, Eigen::all));
  Camera camera = view.name ? cameraFor(seen, *view.name, width, height)
                            : cameraTowards(seen, view.towards, view.up, width, height);
  if (!view.focus.empty()) camera.halfHeight *= 1.3;
  return camera;
}

std::vector<Picture> surfaceViews(const TriangleMesh& mesh, const SurfacePaint& paint,
                                  const std::vector<FigureView>& views,
                                  const SurfacePictureOptions& options) {
  const SurfaceScene scene(mesh);
  const std::vector<Colour> colours = coloursOf(paint, mesh.vertexCount());
  const bool discrete = paint.values.size() == 0 && paint.labels.size() != 0;
  std::vector<Picture> pictures;
  for (const FigureView& view : views) {
    pictures.push_back(scene.render(cameraOf(mesh.positions, view, options.width, options.height),
                                    colours, discrete ? Filling::Discrete : Filling::Smooth,
                                    options));
  }
  return pictures;
}

Picture surfaceFigure(const TriangleMesh& mesh, const SurfacePaint& paint,
                      const std::vector<FigureView>& views, int columns,
                      const SurfacePictureOptions& options) {
  return withColourBar(tilePictures(surfaceViews(mesh, paint, views, options), columns), paint);
}

Picture withColourBar(Picture tiled, const SurfacePaint& paint) {
  if (paint.values.size() == 0) return tiled;
  constexpr int kBeside = 10;  // pixels
  const int barHeight = std::min(std::max(tiled.height * 3 / 5, 120), tiled.height);
  const double letters = std::clamp(barHeight / 24.0, 8.0, 14.0);
  const int width =
      std::max({90, std::min(130, tiled.height / 5 - 2 * kBeside),
                static_cast<int>(std::ceil(textWidth(barTitle(paint.scale), letters)))});
  Canvas whole(tiled.width + width + 2 * kBeside, tiled.height);
  drawColourBar(whole, paint.scale,
                {tiled.width + kBeside, (tiled.height - barHeight) / 2 + 3 * letters},
                {width / 6.0, barHeight - 4 * letters}, letters);
  const Point2 size(tiled.width, tiled.height);
  whole.image({0, 0}, size, std::move(tiled));
  return whole.picture();
}

Eigen::AlignedBox3d boxAbove(const Volume<float>& image, double threshold) {
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v < image.size(); ++v) {
    if (image[v] > threshold) box.extend(centreOf(image.grid, v));
  }
  return box;
}

}  // namespace explica::report
