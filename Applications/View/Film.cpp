// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Film.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Pipeline/UnfoldingFolder.h"
#include "Explica/Report/Film.h"
#include "OpenedFolders.h"

#include <cmath>
#include <string>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr report::Colour kInside = {0.74F, 0.31F, 0.09F};
constexpr report::Colour kOutside = {0.60F, 0.58F, 0.55F};

std::vector<fs::path> framesOf(const fs::path& folder) {
  std::vector<fs::path> files = pipeline::frameFiles(folder);
  if (files.empty()) {
    throw InvalidInput(folder.string() +
                       ": holds no frames/frame-*.surf.gii; unfold with --frames");
  }
  return files;
}

std::string captionOf(const Json& summary, std::size_t frame, std::size_t count) {
  const double visibility = pipeline::frameVisibility(summary, frame);
  if (!std::isfinite(visibility)) return "";
  std::string caption = printed("average visibility %.2f", visibility);
  if (frame + 1 == count && summary.contains("area_error_mean")) {
    caption += printed("   areas kept to %.2g %%", 100 * summary.value("area_error_mean", kNaN));
  }
  return caption;
}

/// From the unfolding's own viewpoint, where its summary tells it.
report::FigureView fromViewpoint(const Json& summary, const TriangleMesh& mesh,
                                 const std::vector<std::int32_t>& region) {
  report::FigureView view;
  const auto viewpoint = pipeline::pointIn(summary, "viewpoint");
  if (!viewpoint) return view;
  Point middle = Point::Zero();
  for (const std::int32_t v : region) middle += mesh.positions.row(v).transpose();
  middle /= std::max<double>(1, static_cast<double>(region.size()));
  view.towards = middle - *viewpoint;
  return view;
}

}  // namespace

TriangleMesh firstFrame(const fs::path& folder) {
  return io::readSurface(framesOf(folder).front()).mesh;
}

std::vector<report::Picture> drawFilm(const fs::path& folder,
                                      const std::optional<report::SurfacePaint>& paint,
                                      std::vector<report::FigureView> views, int columns,
                                      bool focus, const report::SurfacePictureOptions& options) {
  const Json summary = summaryOf(folder);
  const std::vector<fs::path> files = framesOf(folder);
  std::vector<report::FilmFrame> frames;
  for (std::size_t n = 0; n < files.size(); ++n) {
    frames.push_back({io::readSurface(files[n]).mesh, captionOf(summary, n, files.size())});
  }
  const Eigen::Index vertices = frames.front().mesh.vertexCount();
  report::FilmLook look;
  const std::vector<std::int32_t> region = pipeline::unfoldedRegion(folder, vertices);
  if (paint) {
    look.colours = report::coloursOf(*paint, vertices);
    look.filling = paint->values.size() == 0 ? report::Filling::Discrete : report::Filling::Smooth;
  } else if (!region.empty()) {
    look.colours.assign(static_cast<std::size_t>(vertices), kOutside);
    look.keys.assign(static_cast<std::size_t>(vertices), 0);
    for (const std::int32_t v : region) {
      look.colours[v] = kInside;
      look.keys[v] = 1;
    }
    look.filling = report::Filling::Discrete;
  }
  if (views.empty()) views = {fromViewpoint(summary, frames.front().mesh, region)};
  std::vector<std::vector<report::Picture>> bySide;
  for (const report::FigureView& view : views) {
    look.view = view;
    if (focus) look.view.focus = region;
    bySide.push_back(report::filmPictures(frames, look, options));
  }
  std::vector<report::Picture> pictures;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    std::vector<report::Picture> beside;
    for (auto& side : bySide) beside.push_back(std::move(side[n]));
    pictures.push_back(beside.size() == 1 ? std::move(beside.front())
                                          : report::tilePictures(beside, columns));
  }
  return pictures;
}

}  // namespace explica::app
