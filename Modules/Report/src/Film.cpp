// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Film.h"

#include "Explica/Core/Errors.h"
#include "Explica/Report/Drawing.h"

#include <algorithm>

namespace explica::report {
namespace {

constexpr double kLetters = 0.026;  // height of the caption's capitals, of the picture's
constexpr int kCaptionRows = 3;     // height of the caption's strip, in capitals

/// All positions of the focus in all frames, as a mesh that a camera can be fitted to.
TriangleMesh placesOf(const std::vector<FilmFrame>& frames,
                      const std::vector<std::int32_t>& focus) {
  TriangleMesh all;
  const auto each = static_cast<Eigen::Index>(
      focus.empty() ? static_cast<std::size_t>(frames.front().mesh.vertexCount()) : focus.size());
  all.positions.resize(each * static_cast<Eigen::Index>(frames.size()), 3);
  Eigen::Index row = 0;
  for (const FilmFrame& frame : frames) {
    for (Eigen::Index n = 0; n < each; ++n) {
      all.positions.row(row++) = frame.mesh.positions.row(focus.empty() ? n : focus[n]);
    }
  }
  return all;
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
  const Camera camera =
      cameraTowards(placesOf(frames, look.focus), look.towards, look.up, drawn.width, drawn.height);
  std::vector<Picture> pictures;
  for (const FilmFrame& frame : frames) {
    Picture whole(options.width, options.height);
    pastePicture(
        whole,
        SurfaceScene(frame.mesh)
            .render(camera, look.colours, look.filling, drawn, look.keys, Border::AroundFaces),
        0, 0);
    drawText(whole, frame.caption, Eigen::Vector2d(0.5 * options.width, options.height - letters),
             letters, {0.02F, 0.02F, 0.02F}, TextAnchor::Middle);
    pictures.push_back(std::move(whole));
  }
  return pictures;
}

}  // namespace explica::report
