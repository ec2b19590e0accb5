// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "HalfwaySurface.h"

#include "Explica/Core/DisjointSets.h"

#include <algorithm>
#include <map>
#include <utility>

namespace explica::correspondence {

namespace {

using Doubled = std::array<std::int32_t, 3>;  ///< twice a box index: odd at voxel corners

/// A link between u < 1/2 and u >= 1/2, seen as the voxel face across it.
struct Crossing {
  Vector x;                ///< where u = 1/2, box index
  std::int32_t low = 0;    ///< box voxel on the inner side
  std::int32_t home = -1;  ///< a tissue voxel at one of its ends
  int axis = 0;
  int sign = 1;    ///< from the inner to the outer side along the axis
  Doubled centre;  ///< of the voxel face
};

std::vector<Crossing> crossingsOf(const harmonic::Annulus& annulus, const std::vector<double>& u) {
  std::vector<Crossing> crossings;
  const auto strides = annulus.strides();
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const auto s = annulus.boxSubscripts(n);
    const std::int32_t row = annulus.irregular(n);
    const bool low = u[n] < 0.5;
    for (int d = 0; d < (annulus.planar ? 4 : 6); ++d) {
      const std::int32_t m = annulus.links[n][d];
      double beyond = m == harmonic::kInner ? 0 : m == harmonic::kOuter ? 1 : kNaN;
      double place = m < 0 && row >= 0 ? annulus.fractions[row][d] : 1;
      if (m >= 0) beyond = u[m];
      if (std::isnan(beyond) || low == (beyond < 0.5) || (m >= 0 && !low)) continue;
      const int a = harmonic::axisOf(d), sign = harmonic::signOf(d);
      const std::int32_t neighbour = annulus.place[n] + sign * strides[a];
      // Where a sheet without thickness parts two tissue voxels, both would have this face.
      if (m < 0 && annulus.numberAt[neighbour] >= 0) continue;
      Crossing c;
      place *= (0.5 - u[n]) / (beyond - u[n]);
      c.x = Vector(s[0], s[1], s[2]);
      c.x[a] += sign * place;
      c.low = low ? annulus.place[n] : neighbour;
      c.home = n;
      c.axis = a;
      c.sign = low ? sign : -sign;
      c.centre = {2 * s[0], 2 * s[1], 2 * s[2]};
      c.centre[a] += sign;
      crossings.push_back(c);
    }
  }
  return crossings;
}

/// Corners of a crossing's voxel face, counter-clockwise seen along -axis in index space.
class FaceCorners {
 public:
  explicit FaceCorners(bool planar) : planar_(planar), count_(planar ? 2 : 4) {}

  [[nodiscard]] int count() const { return count_; }

  [[nodiscard]] Doubled corner(const Crossing& c, int corner) const {
    const auto [b, e] = acrossAxes(c.axis);
    Doubled at = c.centre;
    at[b] += (corner == 1 || corner == 2) ? 1 : -1;
    if (!planar_) at[e] += corner >= 2 ? 1 : -1;
    return at;
  }

  /// Middle of the side between a corner and the next; in the plane, the corner itself.
  [[nodiscard]] Doubled side(const Crossing& c, int corner) const {
    if (planar_) return this->corner(c, corner);
    const Doubled p = this->corner(c, corner), q = this->corner(c, (corner + 1) % 4);
    return {(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2};
  }

 private:
  [[nodiscard]] std::pair<int, int> acrossAxes(int axis) const {
    return planar_ ? std::pair{1 - axis, 2} : std::pair{(axis + 1) % 3, (axis + 2) % 3};
  }
  bool planar_;
  int count_;
};

/// Which sheet of the surface a crossing belongs to at each corner of its voxel face.  Joins
/// crossings that share a side of their voxel faces.  Where four meet at a side, those of the same
/// inner voxel belong together.
DisjointSets sheetsOf(const std::vector<Crossing>& crossings, const FaceCorners& face) {
  const auto corners = static_cast<std::int32_t>(face.count());
  DisjointSets sheets(crossings.size() * corners);
  std::map<Doubled, std::vector<std::pair<std::size_t, int>>> atSide;
  for (std::size_t f = 0; f < crossings.size(); ++f) {
    for (int k = 0; k < face.count(); ++k) atSide[face.side(crossings[f], k)].emplace_back(f, k);
  }
  const auto join = [&](std::pair<std::size_t, int> a, std::pair<std::size_t, int> b) {
    const int ends = face.count() == 2 ? 1 : 2;
    for (int p = 0; p < ends; ++p) {
      for (int q = 0; q < ends; ++q) {
        const int i = (a.second + p) % face.count(), j = (b.second + q) % face.count();
        if (face.corner(crossings[a.first], i) != face.corner(crossings[b.first], j)) continue;
        sheets.join(static_cast<std::int32_t>(a.first) * corners + i,
                    static_cast<std::int32_t>(b.first) * corners + j);
      }
    }
  };
  for (const auto& [side, meeting] : atSide) {
    for (std::size_t p = 0; p < meeting.size(); ++p) {
      for (std::size_t q = p + 1; q < meeting.size(); ++q) {
        const bool sameVoxel = crossings[meeting[p].first].low == crossings[meeting[q].first].low;
        if (meeting.size() <= 2 || sameVoxel) join(meeting[p], meeting[q]);
      }
    }
  }
  return sheets;
}

/// What is gathered of a vertex while its crossings are passed.
struct Gathered {
  Vector sum = Vector::Zero();
  int count = 0;
  std::array<bool, 3> below = {}, above = {}, along = {};  ///< crossings on each side of the corner
};

/// Mean of the crossings.  Where all lie on one side of the corner the surface ends there (at an
/// insulated plane), half a voxel further on.
Vector placeOf(const Gathered& g, const Doubled& corner, bool planar) {
  Vector x = g.sum / g.count;
  for (int a = 0; a < (planar ? 2 : 3); ++a) {
    if (!g.along[a] && g.below[a] != g.above[a]) x[a] = 0.5 * corner[a];
  }
  return x;
}

}  // namespace

HalfwaySurface halfwaySurface(const harmonic::Annulus& annulus, const std::vector<double>& u) {
  const std::vector<Crossing> crossings = crossingsOf(annulus, u);
  const FaceCorners face(annulus.planar);
  DisjointSets sheets = sheetsOf(crossings, face);
  HalfwaySurface surface;
  std::vector<Gathered> gathered;
  std::vector<Doubled> cornerOf;
  std::map<std::int32_t, std::int32_t> vertexOf;
  for (std::size_t f = 0; f < crossings.size(); ++f) {
    const Crossing& c = crossings[f];
    std::array<std::int32_t, 4> corners = {-1, -1, -1, -1};
    for (int k = 0; k < face.count(); ++k) {
      const Doubled corner = face.corner(c, k);
      const std::int32_t sheet = sheets.root(static_cast<std::int32_t>(f) * face.count() + k);
      const auto [at, isNew] =
          vertexOf.try_emplace(sheet, static_cast<std::int32_t>(surface.vertices.size()));
      if (isNew) {
        surface.vertices.push_back({Vector::Zero(), c.home});
        gathered.emplace_back();
        cornerOf.push_back(corner);
      }
      Gathered& g = gathered[at->second];
      g.sum += c.x;
      ++g.count;
      g.along[c.axis] = true;
      for (int a = 0; a < 3; ++a) {
        if (a != c.axis) (c.centre[a] < corner[a] ? g.below : g.above)[a] = true;
      }
      corners[k] = at->second;
    }
    const bool turned = annulus.planar && c.axis == 0;  // the other axis is then to the left
    if ((c.sign < 0) != turned) std::swap(corners[0], corners[annulus.planar ? 1 : 2]);
    surface.faces.push_back(corners);
  }
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    surface.vertices[v].x = placeOf(gathered[v], cornerOf[v], annulus.planar);
  }
  return surface;
}

}  // namespace explica::correspondence
