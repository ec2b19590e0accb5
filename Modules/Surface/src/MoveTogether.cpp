// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MoveTogether.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <algorithm>
#include <array>

namespace explica::surface {
namespace {

using FaceMarks = std::vector<std::uint8_t>;

/// A lattice of cells over a mesh, a mark each.
class MarkedCells {
 public:
  explicit MarkedCells(const TriangleMesh& mesh) : mesh_(mesh) {
    constexpr double kCells = 128;  // along the longest side: about an edge of a fine surface
    const Point low = mesh.positions.colwise().minCoeff().transpose();
    const Vector size = mesh.positions.colwise().maxCoeff().transpose() - low;
    const double perMm = (kCells - 1) / std::max(size.maxCoeff(), 1e-300);
    for (int a = 0; a < 3; ++a) count_[a] = static_cast<int>(size[a] * perMm) + 1;
    cells_.resize(static_cast<std::size_t>(mesh.vertexCount()));
    parallelFor(cells_.size(), 4096, [&](std::size_t v) {
      for (int a = 0; a < 3; ++a) {
        const double place = (mesh.positions(static_cast<Eigen::Index>(v), a) - low[a]) * perMm;
        cells_[v][a] = static_cast<std::uint8_t>(std::min(static_cast<int>(place), count_[a] - 1));
      }
    });
    marked_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2], 0);
  }

  void mark(Eigen::Index face) {
    forCells(face, [&](std::size_t cell) {
      marked_[cell] = 1;
      return true;
    });
  }
  [[nodiscard]] bool touches(Eigen::Index face) const {
    return !forCells(face, [&](std::size_t cell) { return marked_[cell] == 0; });
  }

 private:
  using Cell = std::array<std::uint8_t, 3>;

  /// Visits the cells of a face's box until a visit says false; whether none did.
  template <class Visit>
  bool forCells(Eigen::Index face, const Visit& visit) const {
    const Cell &p = cells_[mesh_.faces(face, 0)], &q = cells_[mesh_.faces(face, 1)],
               &r = cells_[mesh_.faces(face, 2)];
    Cell first, last;
    for (int a = 0; a < 3; ++a) {
      first[a] = std::min({p[a], q[a], r[a]});
      last[a] = std::max({p[a], q[a], r[a]});
    }
    for (int k = first[2]; k <= last[2]; ++k) {
      for (int j = first[1]; j <= last[1]; ++j) {
        const std::size_t row =
            (static_cast<std::size_t>(k) * count_[1] + j) * static_cast<std::size_t>(count_[0]);
        for (int i = first[0]; i <= last[0]; ++i) {
          if (!visit(row + i)) return false;
        }
      }
    }
    return true;
  }

  const TriangleMesh& mesh_;
  std::vector<Cell> cells_;  ///< of the vertices
  std::array<int, 3> count_ = {1, 1, 1};
  std::vector<std::uint8_t> marked_;
};

/// Pairs of faces that meet, at least one of each pair marked.
std::vector<geometry::FacePair> meetings(const TriangleMesh& mesh, const FaceMarks& marked) {
  constexpr double kMany = 0.5;  // share of faces beyond which all are looked through
  const auto count = std::count(marked.begin(), marked.end(), std::uint8_t{1});
  if (static_cast<double>(count) > kMany * static_cast<double>(marked.size())) {
    return geometry::findSelfIntersections(mesh);
  }
  MarkedCells cells(mesh);
  for (std::size_t f = 0; f < marked.size(); ++f) {
    if (marked[f]) cells.mark(static_cast<Eigen::Index>(f));
  }
  std::vector<std::uint8_t> near(marked.size());
  parallelFor(marked.size(), 4096,
              [&](std::size_t f) { near[f] = cells.touches(static_cast<Eigen::Index>(f)); });
  std::vector<std::int32_t> faces;
  std::vector<bool> isMarked;
  for (std::size_t f = 0; f < marked.size(); ++f) {
    if (!near[f]) continue;
    faces.push_back(static_cast<std::int32_t>(f));
    isMarked.push_back(marked[f] != 0);
  }
  TriangleMesh part;
  part.positions = mesh.positions;
  part.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t n = 0; n < faces.size(); ++n) {
    part.faces.row(static_cast<Eigen::Index>(n)) = mesh.faces.row(faces[n]);
  }
  std::vector<geometry::FacePair> pairs = geometry::findSelfIntersections(part, isMarked);
  for (geometry::FacePair& pair : pairs) {
    for (std::int32_t& face : pair) face = faces[face];
  }
  return pairs;
}

/// Marks the faces that have a corner among the marked vertices.
FaceMarks facesAt(const TriangleMesh& mesh, const std::vector<std::uint8_t>& vertexMarked) {
  FaceMarks marked(static_cast<std::size_t>(mesh.faceCount()));
  parallelFor(marked.size(), 1 << 14, [&](std::size_t f) {
    const auto row = static_cast<Eigen::Index>(f);
    marked[f] = vertexMarked[mesh.faces(row, 0)] | vertexMarked[mesh.faces(row, 1)] |
                vertexMarked[mesh.faces(row, 2)];
  });
  return marked;
}

}  // namespace

Point asStored(const Point& p) {
  Point stored;
  for (int a = 0; a < 3; ++a) {
    // Volatile: GCC 12 at -O3 takes the way to float and back for nothing when it joins two
    // components into one vector.
    const volatile float rounded = static_cast<float>(p[a]);
    stored[a] = rounded;
  }
  return stored;
}

std::vector<std::uint8_t> moveTogether(TriangleMesh& mesh,
                                       const std::vector<std::int32_t>& vertices, int attempts,
                                       const Attempts& to) {
  constexpr std::int32_t kStays = -1;
  std::vector<std::uint8_t> attempt(vertices.size(), 0);
  std::vector<std::int32_t> listed(static_cast<std::size_t>(mesh.vertexCount()), kStays);
  std::vector<std::uint8_t> changed(listed.size(), 0);
  Positions start(static_cast<Eigen::Index>(vertices.size()), 3);
  parallelFor(vertices.size(), 1024, [&](std::size_t n) {
    const std::int32_t v = vertices[n];
    listed[v] = static_cast<std::int32_t>(n);
    start.row(static_cast<Eigen::Index>(n)) = mesh.positions.row(v);
    const Point goal = asStored(to(v, 0));
    changed[v] = goal != Point(mesh.positions.row(v));
    mesh.positions.row(v) = goal;
  });
  for (;;) {
    const auto pairs = meetings(mesh, facesAt(mesh, changed));
    if (pairs.empty()) return attempt;
    std::fill(changed.begin(), changed.end(), std::uint8_t{0});
    std::vector<std::int32_t> retreating;
    for (const geometry::FacePair& pair : pairs) {
      for (const std::int32_t face : pair) {
        for (int k = 0; k < 3; ++k) {
          const std::int32_t v = mesh.faces(face, k);
          if (changed[v] || listed[v] == kStays || attempt[listed[v]] == attempts) continue;
          changed[v] = 1;
          retreating.push_back(v);
        }
      }
    }
    parallelFor(retreating.size(), 256, [&](std::size_t n) {
      const std::int32_t v = retreating[n], row = listed[v];
      const int next = ++attempt[row];
      if (next == attempts) {
        mesh.positions.row(v) = start.row(row);
      } else {
        mesh.positions.row(v) = asStored(to(v, next));
      }
    });
  }
}

}  // namespace explica::surface
