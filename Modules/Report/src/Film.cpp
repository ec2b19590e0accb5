// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Film.h"

#include "Explica/Core/Errors.h"
#include "Explica/Report/Drawing.h"

#include <algorithm>
#include <numeric>

namespace explica::report {
namespace {

constexpr double kLetters = 0.026;  // height of the caption's capitals, of the picture's
constexpr int kCaptionRows = 3;     // height of the caption's strip, in capitals

/// All places of the focus.
Positions placesOf(const std::vector<FilmFrame>& frames, const std::vector<std::int32_t>& focus) {
  const Positions& first = frames.front().mesh.positions;
  std::vector<std::int32_t> shown = focus;
  if (focus.empty()) {
    shown.resize(static_cast<std::size_t>(first.rows()));
    std::iota(shown.begin(), shown.end(), 0);
  }
  std::vector<Point> places;
  for (const FilmFrame& frame : frames) {
    for (const std::int32_t v : shown) {
      const auto place = frame.mesh.positions.row(v);
      if (&frame == &frames.front() || place != first.row(v)) places.emplace_back(place);
    }
  }
  return Eigen::Map<const Positions>(places.front().data(),
                                     static_cast<Eigen::Index>(places.size()), 3);
}

/// Of each vertex whether it is ever elsewhere than in the first frame.
std::vector<std::uint8_t> movesOf(const std::vector<FilmFrame>& frames) {
  const Positions& first = frames.front().mesh.positions;
  std::vector<std::uint8_t> moves(static_cast<std::size_t>(first.rows()), 0);
  for (const FilmFrame& frame : frames) {
    for (Eigen::Index v = 0; v < first.rows(); ++v) {
      if (frame.mesh.positions.row(v) != first.row(v)) moves[v] = 1;
    }
  }
  return moves;
}

/// How far the film has come, along the picture's lower rim.
void drawProgress(Picture& picture, std::size_t frame, std::size_t count, double letters) {
  const double y = picture.height - letters / 5;
  const double share = static_cast<double>(frame + 1) / static_cast<double>(count);
  drawSegments(picture, {{{0, y}, {share * picture.width, y}}}, {0.35F, 0.35F, 0.35F}, letters / 4);
}

}  // namespace

std::vector<Picture> filmPictures(const std::vector<FilmFrame>& frames, const FilmLook& look,
                                  const SurfacePictureOptions& options) {
  if (frames.empty()) throw InvalidInput("film: no frames");
  for (const FilmFrame& frame : frames) {
    if (frame.mesh.vertexCount() != frames.front().mesh.vertexCount()) {
      throw InvalidInput("film: its frames differ in their number of vertices");
    }
  }
  const double letters = kLetters * options.height;
  const int strip = static_cast<int>(kCaptionRows * letters);
  SurfacePictureOptions drawn = options;
  drawn.height = std::max(1, options.height - strip);
  FigureView all = look.view;
  all.focus.clear();
  const Camera camera = cameraOf(placesOf(frames, look.view.focus), all, drawn.width, drawn.height);
  std::vector<Picture> pictures;
  SurfaceScene scene(frames.front().mesh, movesOf(frames));
  for (const FilmFrame& frame : frames) {
    Picture whole(options.width, options.height);
    if (&frame != &frames.front()) scene.moveTo(frame.mesh);
    pastePicture(whole, scene.render(camera, look.colours, look.filling, drawn, look.keys), 0, 0);
    drawProgress(whole, pictures.size(), frames.size(), letters);
    drawText(whole, frame.caption, Eigen::Vector2d(0.5 * options.width, options.height - letters),
             letters, {0.02F, 0.02F, 0.02F}, TextAnchor::Middle);
    pictures.push_back(std::move(whole));
  }
  return pictures;
}

}  // namespace explica::report
