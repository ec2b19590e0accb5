// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonMeasures.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace explica::planar {
namespace {

/// Share of an edge on which a linear function with these end values is positive.
double positiveShare(double atStart, double atEnd) {
  if (atStart <= 0 && atEnd <= 0) return 0;
  if (atStart >= 0 && atEnd >= 0) return 1;
  return std::max(atStart, atEnd) / std::abs(atEnd - atStart);
}

void requireClosed(const Curve& curve) {
  if (!curve.closed) throw InvalidInput("global measures need a closed polygon");
}

}  // namespace

double hiddenViewingArc(const Curve& curve, const Point2& centre, double radius) {
  return hiddenViewingArcGradient(curve, centre, radius).value;
}

MeasureValue hiddenViewingArcGradient(const Curve& curve, const Point2& centre, double radius) {
  requireClosed(curve);
  MeasureValue result{0, Positions2::Zero(curve.vertexCount(), 2)};
  for (int i = 0; i < curve.edgeCount(); ++i) {
    const int j = curve.next(i);
    const Point2 a = curve.point(i) - centre;
    const Point2 b = curve.point(j) - centre;
    if (a.norm() >= radius) {
      throw InvalidInput("hidden arc: vertex " + std::to_string(i) +
                         " lies on or outside the viewing circle; take a larger radius");
    }
    const double length = (b - a).norm();
    const Point2 tangent = (b - a) / length;
    const double h = (b.y() * a.x() - b.x() * a.y()) / length;
    const double arc = 2 * kPi - 2 * std::acos(h / radius);
    result.value += radius * length * arc;
    // d(L arc) = arc dL + 2 (d(L h) - h dL) / sqrt(r^2 - h^2), and L h is the cross product.
    const double turn = 2 / std::sqrt(radius * radius - h * h);
    const Point2 byEnd = (arc - turn * h) * tangent;
    result.gradient.row(i) += radius * (turn * Point2(b.y(), -b.x()) - byEnd).transpose();
    result.gradient.row(j) += radius * (turn * Point2(-a.y(), a.x()) + byEnd).transpose();
  }
  return result;
}

namespace {

/// The lines of a closed polygon's edges.
struct EdgeLines {
  explicit EdgeLines(const Curve& c)
      : curve(c), lengths(edgeLengths(c)), normals(c.edgeCount(), 2) {
    for (int e = 0; e < c.edgeCount(); ++e) {
      const Point2 t = (c.point(c.next(e)) - c.point(e)) / lengths[e];
      normals.row(e) << t.y(), -t.x();
    }
  }
  /// Distance of a vertex from an edge's line, outward positive.
  [[nodiscard]] double outward(int edge, int vertex) const {
    return normals.row(edge).dot(curve.positions.row(vertex) - curve.positions.row(edge));
  }

  const Curve& curve;
  Eigen::VectorXd lengths;
  Positions2 normals;
};

/// What edge i and the edges [from, to) after it hide of each other, counted once.
double occlusion(const EdgeLines& lines, int i, int from, int to) {
  const Curve& curve = lines.curve;
  const int i1 = curve.next(i);
  double sum = 0;
  double atEnd = lines.outward(i, from);  // the start of j is the end of the edge before
  for (int j = from; j < to; ++j) {
    const int j1 = curve.next(j);
    // An end that lies on the other edge is on its line, whatever rounding says.
    const double yStart = j == i1 ? 0 : atEnd;
    atEnd = lines.outward(i, j1);
    const double yEnd = j1 == i ? 0 : atEnd;
    if (yStart <= 0 && yEnd <= 0) continue;
    const double xStart = i == j1 ? 0 : lines.outward(j, i);
    const double xEnd = i1 == j ? 0 : lines.outward(j, i1);
    if (xStart <= 0 && xEnd <= 0) continue;
    sum += lines.lengths[j] * positiveShare(xStart, xEnd) * positiveShare(yStart, yEnd);
  }
  return lines.lengths[i] * sum;
}

/// A run of edges: the boxes of their ends and of their normals.
struct EdgeRun {
  Eigen::AlignedBox2d ends, normals;
  double length = 0;

  void add(const EdgeRun& other) {
    ends.extend(other.ends);
    normals.extend(other.normals);
    length += other.length;
  }
};

/// Bounds of the distances of b's ends from the lines of a's edges, outward positive.  Rounding is
/// monotone: they hold for EdgeLines::outward to the last bit.
std::pair<double, double> outwardBounds(const EdgeRun& a, const EdgeRun& b) {
  const Eigen::Array2d least = b.ends.min() - a.ends.max();
  const Eigen::Array2d most = b.ends.max() - a.ends.min();
  const Eigen::Array2d low = a.normals.min(), high = a.normals.max();
  const Eigen::Array2d p = low * least, q = low * most, r = high * least, s = high * most;
  return {p.min(q).min(r.min(s)).sum(), p.max(q).max(r.max(s)).sum()};
}

/// Pairs of runs of edges of which all, or none, hide each other are counted at once.
class OcclusionTree {
 public:
  static constexpr int kLeaf = 32;  ///< edges

  explicit OcclusionTree(const EdgeLines& lines) : lines_(lines), levels_(1) {
    const Curve& curve = lines.curve;
    levels_[0].resize(static_cast<std::size_t>((curve.edgeCount() + kLeaf - 1) / kLeaf));
    for (int e = 0; e < curve.edgeCount(); ++e) {
      const Eigen::Vector2d normal = lines.normals.row(e);
      EdgeRun edge{{}, {normal, normal}, lines.lengths[e]};
      edge.ends.extend(curve.point(e)).extend(curve.point(curve.next(e)));
      levels_[0][static_cast<std::size_t>(e / kLeaf)].add(edge);
    }
    while (levels_.back().size() > 1) {
      std::vector<EdgeRun> pairs((levels_.back().size() + 1) / 2);
      for (std::size_t b = 0; b < levels_.back().size(); ++b) pairs[b / 2].add(levels_.back()[b]);
      levels_.push_back(std::move(pairs));
    }
  }

  [[nodiscard]] std::size_t leaves() const { return levels_[0].size(); }

  /// What a leaf's edges and those after them hide of each other, counted once.
  [[nodiscard]] double after(std::size_t leaf) const { return of(leaf, levels_.size() - 1, 0); }

 private:
  [[nodiscard]] double of(std::size_t leaf, std::size_t level, std::size_t run) const {
    if (run >= levels_[level].size() || ((run + 1) << level) <= leaf) return 0;
    if (run << level > leaf) {
      const EdgeRun& a = levels_[0][leaf];
      const EdgeRun& b = levels_[level][run];
      const auto [leastOfB, mostOfB] = outwardBounds(a, b);
      const auto [leastOfA, mostOfA] = outwardBounds(b, a);
      if (mostOfB <= 0 || mostOfA <= 0) return 0;
      if (leastOfB > 0 && leastOfA > 0) return a.length * b.length;
    }
    if (level > 0) return of(leaf, level - 1, 2 * run) + of(leaf, level - 1, 2 * run + 1);
    const int from = static_cast<int>(run) * kLeaf;
    const int to = std::min(from + kLeaf, lines_.curve.edgeCount());
    const int first = static_cast<int>(leaf) * kLeaf;
    const int end = std::min(first + kLeaf, lines_.curve.edgeCount());
    double sum = 0;
    for (int i = first; i < end; ++i) sum += occlusion(lines_, i, std::max(from, i + 1), to);
    return sum;
  }

  const EdgeLines& lines_;
  std::vector<std::vector<EdgeRun>> levels_;  ///< leaves first, the root last
};

}  // namespace

double selfOcclusion(const Curve& curve) {
  requireClosed(curve);
  const EdgeLines lines(curve);
  const OcclusionTree tree(lines);
  std::vector<double> rows(tree.leaves());
  parallelFor(rows.size(), 16, [&](std::size_t leaf) { rows[leaf] = tree.after(leaf); });
  // The condition is the same for (i, j) and (j, i).
  return 2 * std::accumulate(rows.begin(), rows.end(), 0.0);
}

namespace {

/// How a number changes with the ends of two edges: i's start and end, j's start and end.
using ByEnds = Eigen::Matrix<double, 4, 2>;

/// A number and its derivatives.
struct Varying {
  double value = 0;
  ByEnds by = ByEnds::Zero();
};

Varying operator*(const Varying& a, const Varying& b) {
  return {a.value * b.value, a.value * b.by + b.value * a.by};
}

/// Length of the edge between two of the ends.
Varying lengthBetween(const std::array<Point2, 4>& ends, int from) {
  const Point2 way = ends[from + 1] - ends[from];
  Varying length{way.norm()};
  length.by.row(from + 1) = way.transpose() / length.value;
  length.by.row(from) = -length.by.row(from + 1);
  return length;
}

/// Distance of an end from the line of the edge that begins at `from`, outward positive.
Varying outward(const std::array<Point2, 4>& ends, int from, const Varying& length, int end) {
  const Point2 t = ends[from + 1] - ends[from];
  const Point2 d = ends[end] - ends[from];
  const double g = t.y() * d.x() - t.x() * d.y();
  Varying result{g / length.value};
  result.by.row(end) += Eigen::RowVector2d(t.y(), -t.x());
  result.by.row(from + 1) += Eigen::RowVector2d(-d.y(), d.x());
  result.by.row(from) += Eigen::RowVector2d(d.y() - t.y(), t.x() - d.x());
  result.by = (result.by - result.value * length.by) / length.value;
  return result;
}

/// positiveShare() with its derivatives.
Varying positiveShare(const Varying& p, const Varying& q) {
  Varying share{positiveShare(p.value, q.value)};
  if (share.value == 0 || share.value == 1) return share;
  const double span = q.value - p.value;
  share.by = (q.value * p.by - p.value * q.by) / (span * span);
  if (p.value > 0) share.by = -share.by;
  return share;
}

}  // namespace

MeasureValue selfOcclusionGradient(const Curve& curve) {
  requireClosed(curve);
  MeasureValue result{0, Positions2::Zero(curve.vertexCount(), 2)};
  for (int i = 0; i < curve.edgeCount(); ++i) {
    checkpoint();
    for (int j = i + 1; j < curve.edgeCount(); ++j) {
      const std::array<int, 4> vertex = {i, curve.next(i), j, curve.next(j)};
      std::array<Point2, 4> ends;
      for (int k = 0; k < 4; ++k) ends[k] = curve.point(vertex[k]);
      const Varying li = lengthBetween(ends, 0);
      const Varying lj = lengthBetween(ends, 2);
      // A common end lies on both lines, whatever rounding says.
      const Varying none;
      const Varying yShare = positiveShare(vertex[2] == vertex[1] ? none : outward(ends, 0, li, 2),
                                           vertex[3] == vertex[0] ? none : outward(ends, 0, li, 3));
      if (yShare.value == 0) continue;
      const Varying xShare = positiveShare(vertex[0] == vertex[3] ? none : outward(ends, 2, lj, 0),
                                           vertex[1] == vertex[2] ? none : outward(ends, 2, lj, 1));
      if (xShare.value == 0) continue;
      const Varying term = li * lj * xShare * yShare;
      result.value += 2 * term.value;
      for (int k = 0; k < 4; ++k) result.gradient.row(vertex[k]) += 2 * term.by.row(k);
    }
  }
  return result;
}

}  // namespace explica::planar
