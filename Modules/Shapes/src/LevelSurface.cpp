// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Shapes/ShapeLevel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

namespace explica::shapes {
namespace {

// Contours keep off the nodes, so that no two vertices fall together.
constexpr double kOffNode = 0.02;

/// Builds a surface whose vertices lie on the lattice edges of the Freudenthal tetrahedra.
class Builder {
 public:
  Builder(const Volume<float>& field, double level) : field_(field), level_(level) {}

  void addTetrahedron(const std::array<std::size_t, 4>& nodes) {
    std::array<std::size_t, 4> in{};
    std::array<std::size_t, 4> out{};
    int ins = 0;
    int outs = 0;
    for (std::size_t n : nodes) {
      if (field_[n] < level_) {
        in[ins++] = n;
      } else {
        out[outs++] = n;
      }
    }
    if (ins == 1) {
      addFace(in[0], {vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2])});
    } else if (ins == 3) {
      addFace(in[0], {vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0])});
    } else if (ins == 2) {
      const std::array<int, 4> ring = {vertex(in[0], out[0]), vertex(in[0], out[1]),
                                       vertex(in[1], out[1]), vertex(in[1], out[0])};
      addFace(in[0], {ring[0], ring[1], ring[2]});
      addFace(in[0], {ring[0], ring[2], ring[3]});
    }
  }

  [[nodiscard]] TriangleMesh mesh() const {
    TriangleMesh result;
    result.positions.resize(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t v = 0; v < points_.size(); ++v) {
      result.positions.row(static_cast<Eigen::Index>(v)) = points_[v].transpose();
    }
    result.faces.resize(static_cast<Eigen::Index>(faces_.size()), 3);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (int k = 0; k < 3; ++k) result.faces(static_cast<Eigen::Index>(f), k) = faces_[f][k];
    }
    return result;
  }

 private:
  [[nodiscard]] Point place(std::size_t node) const {
    const auto [i, j, k] = field_.grid.subscripts(node);
    return field_.grid.toWorld({double(i), double(j), double(k)});
  }

  int vertex(std::size_t inside, std::size_t outside) {
    // Only looked up, never walked through: the order of vertices is that of the cells.
    const std::size_t key = std::min(inside, outside) * field_.size() + std::max(inside, outside);
    const auto [at, isNew] = numbers_.try_emplace(key, static_cast<int>(points_.size()));
    if (isNew) {
      const double a = field_[inside];
      const double b = field_[outside];
      const double t = std::clamp((level_ - a) / (b - a), kOffNode, 1 - kOffNode);
      points_.push_back(place(inside) + t * (place(outside) - place(inside)));
    }
    return at->second;
  }

  /// Adds a face, turned so that the inside node lies behind it.
  void addFace(std::size_t inside, std::array<int, 3> face) {
    const Point& a = points_[face[0]];
    const Vector normal = (points_[face[1]] - a).cross(points_[face[2]] - a);
    if (normal.dot(place(inside) - a) > 0) std::swap(face[1], face[2]);
    faces_.push_back(face);
  }

  const Volume<float>& field_;
  double level_;
  std::vector<Point> points_;
  std::vector<std::array<int, 3>> faces_;
  std::unordered_map<std::size_t, int> numbers_;
};

}  // namespace

TriangleMesh levelSurfaceOf(const Volume<float>& field, double level) {
  const Grid& grid = field.grid;
  if (grid.dimension() != 3) throw InvalidInput("level surface: the field is a single slice");
  // Six tetrahedra of a cell: the monotone paths from its first to its last node.
  constexpr std::array<std::array<int, 2>, 6> kPaths = {
      {{{0, 1}}, {{0, 2}}, {{1, 0}}, {{1, 2}}, {{2, 0}}, {{2, 1}}}};
  const std::array<std::size_t, 3> step = {1, static_cast<std::size_t>(grid.size[0]),
                                           static_cast<std::size_t>(grid.size[0]) * grid.size[1]};
  Builder builder(field, level);
  for (int k = 0; k + 1 < grid.size[2]; ++k) {
    for (int j = 0; j + 1 < grid.size[1]; ++j) {
      for (int i = 0; i + 1 < grid.size[0]; ++i) {
        const std::size_t first = grid.linear(i, j, k);
        const std::size_t last = first + step[0] + step[1] + step[2];
        int ins = 0;
        for (int corner = 0; corner < 8; ++corner) {
          const std::size_t node = first + (corner & 1) * step[0] + (corner >> 1 & 1) * step[1] +
                                   (corner >> 2 & 1) * step[2];
          ins += field[node] < level;
        }
        if (ins == 0 || ins == 8) continue;
        for (const auto& path : kPaths) {
          const std::size_t second = first + step[path[0]];
          builder.addTetrahedron({first, second, second + step[path[1]], last});
        }
      }
    }
  }
  return builder.mesh();
}

}  // namespace explica::shapes
