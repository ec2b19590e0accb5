// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/LabelVolume.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/VoxelSets.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

namespace explica::maps {
namespace {

constexpr double kApart = 0.25;   // of a voxel: most between neighbouring places of a prism
constexpr double kFilled = 0.5;   // of a voxel must lie between the surfaces
constexpr int kMostPlaces = 100;  // along an edge or across: far faces do not stop the work

/// Volumes of labels in the voxels that have some.
class Shares {
 public:
  explicit Shares(const Grid& grid) : grid_(grid) {}

  void add(const Point& place, Label label, double volume) {
    const std::int64_t voxel = voxelAt(grid_, place);
    if (voxel >= 0) shares_[voxel][label] += volume;
  }

  [[nodiscard]] Volume<Label> largest() const {
    Volume<Label> labels(grid_);
    for (const auto& [voxel, shares] : shares_) {
      double all = 0, most = 0;
      Label best = 0;
      for (const auto& [label, volume] : shares) {
        all += volume;
        if (volume > most) most = volume, best = label;
      }
      if (all >= kFilled * grid_.voxelVolume()) labels[voxel] = std::max(best, 0);
    }
    return labels;
  }

 private:
  const Grid& grid_;
  std::unordered_map<std::size_t, std::map<Label, double>> shares_;
};

/// A face's prism.
struct Prism {
  std::array<Point, 3> white, pial;
  std::array<Label, 3> labels;

  /// Places along an edge and from white to pial.
  [[nodiscard]] std::array<int, 2> counts(double apart) const {
    double edge = 0, across = 0;
    for (int k = 0; k < 3; ++k) {
      edge = std::max(
          {edge, (white[k] - white[(k + 1) % 3]).norm(), (pial[k] - pial[(k + 1) % 3]).norm()});
      across = std::max(across, (pial[k] - white[k]).norm());
    }
    const auto count = [&](double length) {
      return static_cast<int>(std::clamp(std::ceil(length / apart), 1.0, double{kMostPlaces}));
    };
    return {count(edge), count(across)};
  }

  /// Adds the place of these barycentric weights at this depth, which stands for a part in `parts`.
  void add(const Eigen::Vector3d& weights, double depth, double parts, Shares& shares) const {
    std::array<Point, 3> corner;
    Point place = Point::Zero();
    Vector up = Vector::Zero();
    for (int k = 0; k < 3; ++k) {
      corner[k] = (1 - depth) * white[k] + depth * pial[k];
      place += weights[k] * corner[k];
      up += weights[k] * (pial[k] - white[k]);
    }
    const double volume = (corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(up) / 2;
    Eigen::Index nearest = 0;
    weights.maxCoeff(&nearest);
    shares.add(place, labels[nearest], volume / parts);
  }
};

/// The centres of the n * n triangles into which lines parallel to its sides cut a face.
void addPlaces(const Prism& prism, double apart, Shares& shares) {
  const auto [n, layers] = prism.counts(apart);
  for (int layer = 0; layer < layers; ++layer) {
    const double depth = (layer + 0.5) / layers, parts = double{1} * n * n * layers;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        for (int turned = 0; turned < (i + j + 1 < n ? 2 : 1); ++turned) {
          const double a = (i + (turned + 1) / 3.0) / n, b = (j + (turned + 1) / 3.0) / n;
          prism.add({1 - a - b, a, b}, depth, parts, shares);
        }
      }
    }
  }
}

}  // namespace

Volume<Label> labelsBetween(const Grid& grid, const TriangleMesh& white, const TriangleMesh& pial,
                            const VertexKeys& keys) {
  if (white.vertexCount() != pial.vertexCount() || white.faceCount() != pial.faceCount() ||
      white.faces != pial.faces) {
    throw InvalidInput("white and pial surface: they need the same faces");
  }
  if (keys.size() != white.vertexCount()) {
    throw InvalidInput("labels: " + std::to_string(keys.size()) + " of them, for surfaces of " +
                       std::to_string(white.vertexCount()) + " vertices");
  }
  Shares shares(grid);
  for (Eigen::Index f = 0; f < white.faceCount(); ++f) {
    Prism prism;
    for (int k = 0; k < 3; ++k) {
      prism.white[k] = white.corner(f, k);
      prism.pial[k] = pial.corner(f, k);
      prism.labels[k] = keys[white.faces(f, k)];
    }
    addPlaces(prism, kApart * grid.spacing.minCoeff(), shares);
  }
  return shares.largest();
}

Grid gridAround(const Positions& points, double spacing) {
  constexpr int kMargin = 2;  // voxels
  const Eigen::RowVector3d low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
  Grid grid;
  grid.spacing.setConstant(spacing);
  for (int a = 0; a < 3; ++a) {
    const double first = std::floor(low[a] / spacing) - kMargin;
    grid.origin[a] = spacing * first;
    grid.size[a] = static_cast<int>(std::ceil(high[a] / spacing) + kMargin - first) + 1;
  }
  return grid;
}

}  // namespace explica::maps
