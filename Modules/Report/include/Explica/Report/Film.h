// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Figure.h"

#include <string>
#include <vector>

namespace explica::report {

/// A surface on its way, and the words below each picture.
struct FilmFrame {
  TriangleMesh mesh;
  std::string caption;
};

struct FilmLook {
  FigureView view;              ///< its focus is what the picture holds in all frames
  std::vector<Colour> colours;  ///< one a vertex; empty for a plain light grey
  Filling filling = Filling::Smooth;
  std::vector<std::int32_t> keys = {};  ///< one a vertex, 0 off the region; or none
};

/// The pictures of a film: one camera that holds the focus in every frame, no wider than it needs,
/// and a caption below.
/// @throws InvalidInput  no frames, or frames that differ in their number of vertices
[[nodiscard]] std::vector<Picture> filmPictures(const std::vector<FilmFrame>& frames,
                                                const FilmLook& look,
                                                const SurfacePictureOptions& options = {});

}  // namespace explica::report
