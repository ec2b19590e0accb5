// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/Contour.h"

#include "Explica/Core/Errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace explica::planar {
namespace {

/// A slice with a rim of one voxel around it, far below any level.
class Slice {
 public:
  Slice(const Volume<float>& field, int k, double level) : field_(field), k_(k), level_(level) {}
  [[nodiscard]] double above(int i, int j) const {  // value - level
    if (!field_.grid.contains(i, j, k_)) return -1;
    return field_(i, j, k_) - level_;
  }
  [[nodiscard]] bool inside(int i, int j) const { return above(i, j) > 0; }

 private:
  const Volume<float>& field_;
  int k_;
  double level_;
};

/// An edge of the lattice: from node (i, j) along axis 0 or 1.
using LatticeEdge = std::array<int, 3>;

Point2 crossing(const Slice& slice, const LatticeEdge& edge) {
  const auto [i, j, axis] = edge;
  const double a = slice.above(i, j);
  const double b = slice.above(i + (axis == 0), j + (axis == 1));
  // Contours keep off the nodes, so that no two of their points fall together.
  const double t = std::clamp(a / (a - b), 1e-3, 1 - 1e-3);
  return {i + (axis == 0 ? t : 0), j + (axis == 1 ? t : 0)};
}

}  // namespace

PlaneFrame frameOfSlice(const Grid& grid, int k) {
  const Vector normal = grid.direction.col(0).cross(grid.direction.col(1)).normalized();
  PlaneFrame frame{.origin = normal * normal.dot(grid.toWorld({0, 0, static_cast<double>(k)}))};
  // A plane seen from its side with the larger world coordinate shows x to the right.
  Eigen::Index main = 0;
  normal.cwiseAbs().maxCoeff(&main);
  const Vector up = normal[main] < 0 ? Vector(-normal) : normal;
  const Vector across = main == 0 ? Vector::UnitY() : Vector::UnitX();
  frame.axisX = (across - up * up.dot(across)).normalized();
  frame.axisY = up.cross(frame.axisX);
  if (main == 1) frame.axisY = -frame.axisY;  // coronal: superior upward
  return frame;
}

std::vector<Curve> contoursOfSlice(const Volume<float>& field, int k, double level) {
  const Grid& grid = field.grid;
  if (k < 0 || k >= grid.size[2]) {
    throw InvalidInput("slice " + std::to_string(k) + " is not among 0.." +
                       std::to_string(grid.size[2] - 1));
  }
  const Slice slice(field, k, level);
  // Steps with the inside to the left, from the lattice edge where a cell is entered to where it is
  // left.  In a cell whose diagonals disagree, inside corners are kept apart.
  std::map<LatticeEdge, LatticeEdge> next;
  for (int j = -1; j < grid.size[1]; ++j) {
    for (int i = -1; i < grid.size[0]; ++i) {
      const std::array<bool, 4> in = {slice.inside(i, j), slice.inside(i + 1, j),
                                      slice.inside(i + 1, j + 1), slice.inside(i, j + 1)};
      const std::array<LatticeEdge, 4> sides = {LatticeEdge{i, j, 0}, LatticeEdge{i + 1, j, 1},
                                                LatticeEdge{i, j + 1, 0}, LatticeEdge{i, j, 1}};
      // Side s joins corners s and s + 1.  A run of inside corners that begins after side s ends
      // at the next side that goes outside; the contour runs from that end to that begin.
      for (int s = 0; s < 4; ++s) {
        if (in[s] || !in[(s + 1) % 4]) continue;
        int e = (s + 1) % 4;
        while (in[(e + 1) % 4]) e = (e + 1) % 4;
        next[sides[e]] = sides[s];
      }
    }
  }
  const PlaneFrame frame = frameOfSlice(grid, k);
  std::vector<Curve> curves;
  while (!next.empty()) {
    std::vector<Point2> points;
    auto at = next.begin();
    while (at != next.end()) {
      const Point2 index = crossing(slice, at->first);
      points.push_back(frame.toPlane(grid.toWorld({index.x(), index.y(), static_cast<double>(k)})));
      const LatticeEdge following = at->second;
      next.erase(at);
      at = next.find(following);
    }
    Curve curve;
    curve.positions.resize(static_cast<Eigen::Index>(points.size()), 2);
    for (std::size_t p = 0; p < points.size(); ++p) {
      curve.positions.row(p) = points[p].transpose();
    }
    curves.push_back(std::move(curve));
  }
  // The lattice may be a mirror image of the plane's frame.
  const Vector lattice = grid.direction.col(0).cross(grid.direction.col(1));
  const bool mirrored = lattice.dot(frame.axisX.cross(frame.axisY)) < 0;
  for (Curve& curve : curves) {
    if (mirrored) curve.positions = curve.positions.colwise().reverse().eval();
  }
  std::ranges::stable_sort(curves, [](const Curve& a, const Curve& b) {
    return std::abs(signedArea(a.positions)) > std::abs(signedArea(b.positions));
  });
  return curves;
}

std::vector<Curve> contoursOfLabel(const Volume<Label>& labels, Label label, int k,
                                   const ContourOptions& options) {
  const Grid& grid = labels.grid;
  if (k < 0 || k >= grid.size[2]) {
    throw InvalidInput("slice " + std::to_string(k) + " is not among 0.." +
                       std::to_string(grid.size[2] - 1));
  }
  if (!(options.smoothing >= 0)) throw InvalidInput("smoothing must not be negative");
  Grid plane = grid;
  plane.size[2] = 1;
  plane.origin = grid.toWorld({0, 0, static_cast<double>(k)});
  Volume<float> mask(plane);
  bool any = false;
  for (int j = 0; j < grid.size[1]; ++j) {
    for (int i = 0; i < grid.size[0]; ++i) {
      const bool in = labels(i, j, k) == label;
      mask(i, j, 0) = in ? 1.0F : 0.0F;
      any = any || in;
    }
  }
  if (!any) {
    const int best = largestSlice(labels, label);
    throw InvalidInput("label " + std::to_string(label) + " is absent from slice " +
                       std::to_string(k) +
                       (best < 0 ? std::string(" and from the whole volume")
                                 : "; slice " + std::to_string(best) + " holds most of it"));
  }
  // Gaussian, one axis after the other.
  const int reach = static_cast<int>(std::ceil(4 * options.smoothing));
  for (int axis = 0; axis < 2 && reach > 0; ++axis) {
    Volume<float> smooth(plane);
    for (int j = 0; j < plane.size[1]; ++j) {
      for (int i = 0; i < plane.size[0]; ++i) {
        double sum = 0;
        double weights = 0;
        for (int d = -reach; d <= reach; ++d) {
          const double weight = std::exp(-0.5 * d * d / (options.smoothing * options.smoothing));
          const int ii = i + (axis == 0 ? d : 0);
          const int jj = j + (axis == 1 ? d : 0);
          weights += weight;
          if (plane.contains(ii, jj, 0)) sum += weight * mask(ii, jj, 0);
        }
        smooth(i, j, 0) = static_cast<float>(sum / weights);
      }
    }
    mask = std::move(smooth);
  }
  return contoursOfSlice(mask, 0, 0.5);
}

int largestSlice(const Volume<Label>& labels, Label label) {
  int best = -1;
  std::size_t most = 0;
  const std::size_t sliceSize = static_cast<std::size_t>(labels.grid.size[0]) * labels.grid.size[1];
  for (int k = 0; k < labels.grid.size[2]; ++k) {
    const auto first = labels.data.begin() + static_cast<std::ptrdiff_t>(k * sliceSize);
    const auto count = static_cast<std::size_t>(
        std::count(first, first + static_cast<std::ptrdiff_t>(sliceSize), label));
    if (count > most) {
      most = count;
      best = k;
    }
  }
  return best;
}

Curve resampled(const Curve& curve, int edges) {
  if (edges < 3) throw InvalidInput("a closed curve needs at least 3 edges");
  const Eigen::VectorXd lengths = edgeLengths(curve);
  const double total = lengths.sum();
  Curve result;
  result.positions.resize(edges, 2);
  int e = 0;
  double before = 0;
  for (int k = 0; k < edges; ++k) {
    const double along = total * k / edges;
    while (e + 1 < curve.edgeCount() && before + lengths[e] <= along) before += lengths[e++];
    const double share = std::clamp((along - before) / lengths[e], 0.0, 1.0);
    result.positions.row(k) =
        (1 - share) * curve.positions.row(e) + share * curve.positions.row(curve.next(e));
  }
  return result;
}

}  // namespace explica::planar
