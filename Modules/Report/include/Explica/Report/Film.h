// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/SurfacePicture.h"

#include <string>
#include <vector>

namespace explica::report {

/// A surface on its way, and the words below each picture.
struct FilmFrame {
  TriangleMesh mesh;
  std::string caption;
};

struct FilmLook {
  Vector towards = Vector(1, 0, 0);  ///< direction of sight, any length > 0
  Vector up = Vector(0, 0, 1);
  std::vector<std::int32_t> focus;  ///< vertices that the picture holds in all frames; empty: all
  std::vector<Colour> colours;      ///< one a vertex; empty for a plain light grey
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
