// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/IsoSurface.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OutermostLayer.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>

namespace explica::geometry {
namespace {

/// Corners of a cell are numbered by bits: 1 along i, 2 along j, 4 along k.
constexpr std::array<std::array<int, 4>, 6> kTetrahedra = {
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

/// Walks cells slice by slice and remembers the vertices on the edges of two slices.
class Marcher {
 public:
  /// @param known  1 where the level is known; empty: everywhere
  Marcher(const Volume<float>& level, const Volume<std::uint8_t>& known)
      : level_(level), known_(known), size_(level.grid.size) {
    for (auto& slice : vertexOnEdge_) slice.assign(7ul * size_[0] * size_[1], -1);
    turned_ = level.grid.direction.determinant() < 0;
  }

  TriangleMesh run() {
    for (int k = 0; k + 1 < size_[2]; ++k) {
      for (int j = 0; j + 1 < size_[1]; ++j) {
        for (int i = 0; i + 1 < size_[0]; ++i) visitCell(i, j, k);
      }
      std::swap(vertexOnEdge_[0], vertexOnEdge_[1]);
      std::ranges::fill(vertexOnEdge_[1], -1);
    }
    TriangleMesh mesh;
    mesh.positions.resize(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t v = 0; v < points_.size(); ++v) mesh.positions.row(v) = points_[v];
    mesh.faces.resize(static_cast<Eigen::Index>(faces_.size()), 3);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (int c = 0; c < 3; ++c) mesh.faces(f, c) = faces_[f][c];
    }
    return mesh;
  }

 private:
  void visitCell(int i, int j, int k) {
    unsigned inside = 0;
    for (int c = 0; c < 8; ++c) {
      value_[c] = level_(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
      if (value_[c] > 0) inside |= 1u << c;
    }
    if (inside == 0 || inside == 0xff || !isKnown(i, j, k)) return;
    corner_ = {i, j, k};
    for (const auto& tetrahedron : kTetrahedra) visitTetrahedron(tetrahedron, inside);
  }

  [[nodiscard]] bool isKnown(int i, int j, int k) const {
    if (known_.size() == 0) return true;
    bool all = true;
    for (int c = 0; c < 8; ++c) all = all && known_(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
    return all;
  }

  void visitTetrahedron(std::array<int, 4> t, unsigned inside) {
    // Inside corners first, by swaps; each swap turns the orientation.
    bool even = !turned_;
    int count = 0;
    for (int c = 0; c < 4; ++c) {
      if (!(inside >> t[c] & 1u)) continue;
      if (c != count) {
        std::swap(t[c], t[count]);
        even = !even;
      }
      ++count;
    }
    if (count == 1) {
      addFace(vertexOn(t[0], t[1]), vertexOn(t[0], t[2]), vertexOn(t[0], t[3]), even);
    } else if (count == 3) {
      addFace(vertexOn(t[3], t[0]), vertexOn(t[3], t[1]), vertexOn(t[3], t[2]), even);
    } else if (count == 2) {
      const int ac = vertexOn(t[0], t[2]), ad = vertexOn(t[0], t[3]);
      const int bd = vertexOn(t[1], t[3]), bc = vertexOn(t[1], t[2]);
      if ((points_[ac] - points_[bd]).squaredNorm() <= (points_[ad] - points_[bc]).squaredNorm()) {
        addFace(ac, ad, bd, even);
        addFace(ac, bd, bc, even);
      } else {
        addFace(ac, ad, bc, even);
        addFace(ad, bd, bc, even);
      }
    }
  }

  void addFace(int a, int b, int c, bool even) {
    faces_.push_back(even ? std::array{a, b, c} : std::array{a, c, b});
  }

  int vertexOn(int a, int b) {
    if (a > b) std::swap(a, b);
    const int step = b ^ a;  // a bit an axis, as of corners
    const int i = corner_[0] + (a & 1), j = corner_[1] + (a >> 1 & 1), up = a >> 2;
    int& vertex = vertexOnEdge_[up][7ul * (i + static_cast<std::size_t>(size_[0]) * j) + step - 1];
    if (vertex < 0) {
      const double t = std::clamp(static_cast<double>(value_[a]) / (value_[a] - value_[b]),
                                  kLeastFraction, 1 - kLeastFraction);
      const Vector low(i, j, corner_[2] + up);
      const Vector way(step & 1, step >> 1 & 1, step >> 2);
      vertex = static_cast<int>(points_.size());
      points_.push_back(level_.grid.toWorld(low + t * way));
    }
    return vertex;
  }

  const Volume<float>& level_;
  const Volume<std::uint8_t>& known_;
  std::array<int, 3> size_;
  bool turned_ = false;
  std::array<int, 3> corner_ = {0, 0, 0};
  std::array<float, 8> value_ = {};
  std::array<std::vector<int>, 2> vertexOnEdge_;
  std::vector<Point> points_;
  std::vector<std::array<int, 3>> faces_;
};

void requireNegativeBorder(const Volume<float>& level) {
  forOutermost(level.grid, [&](int i, int j, int k) {
    if (level(i, j, k) > 0) {
      throw InvalidInput(
          "level: positive on the border of its box; widen the box by a layer of background");
    }
  });
}

}  // namespace

TriangleMesh extractIsoSurface(const Volume<float>& level) {
  requireNegativeBorder(level);
  const Volume<std::uint8_t> everywhere;
  return Marcher(level, everywhere).run();
}

TriangleMesh extractIsoSurface(const Volume<float>& level, const Volume<std::uint8_t>& known) {
  return Marcher(level, known).run();
}

}  // namespace explica::geometry
