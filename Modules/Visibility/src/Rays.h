// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Occluders.h"

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Visibility/Viewpoints.h"

#include <functional>
#include <string>
#include <vector>

namespace explica::visibility {

/// Where positions count from, for single precision, and how far from there any is.
struct Frame {
  Point middle;
  double radius;  ///< mm
};
[[nodiscard]] Frame frameOf(const Positions& positions);

/// @throws InvalidInput  no face, no viewpoint, or a non-finite position; `what` starts the message
void requireInputs(const TriangleMesh& mesh, const Viewpoints& viewpoints, const std::string& what);

/// Rays from samples of faces to the viewpoints.
class Rays {
 public:
  /// @param subdivision  samples are the centroids of subdivision^2 equal sub-triangles
  Rays(const TriangleMesh& mesh, const Viewpoints& viewpoints, int subdivision, const Frame& frame);

  /// Shares of a face's area: what is seen, and what arrives of the flux.
  struct Share {
    double seen = 0;
    double arriving = 0;
  };
  /// Calls keep(face, share) for the first `count` faces, on several threads: rays of neighbours
  /// are cast together.
  void look(std::size_t count, const std::function<void(std::size_t, const Share&)>& keep) const;

 private:
  [[nodiscard]] std::vector<Share> sharesOf(std::size_t begin, std::size_t end) const;

  const TriangleMesh& mesh_;
  const Viewpoints& viewpoints_;
  Frame frame_;
  Occluders occluders_;
  std::vector<Vector> samples_;  ///< barycentric coordinates
};

}  // namespace explica::visibility
