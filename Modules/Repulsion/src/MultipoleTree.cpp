// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/MultipoleTree.h"

#include "Assembly.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Repulsion/PairIntegral.h"
#include "MovingSet.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace explica::repulsion {
namespace {

constexpr int kLeafFaces = 4;

/// Distance from a target face, in radii of the largest source face, from which second moments
/// stand for the extent of both.
constexpr double kCarry = 2.5;

/// Faces seen as one.
struct Cluster {
  Point centre = Point::Zero();                      ///< centroid of the area, mm
  double area = 0;                                   ///< mm^2
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< of the area about the centre, mm^4
  double radius = 0;                                 ///< of the ball that holds the faces, mm
  double largestFace = 0;  ///< largest distance of a face's corner from its centroid, mm
};

struct Face : Cluster {
  Corners corners;
  Corners points;  ///< of the rule of degree 2, which weighs them alike
};

Face faceOf(const Corners& corners) {
  Face face;
  face.corners = corners;
  face.centre = (corners[0] + corners[1] + corners[2]) / 3;
  face.area = faceArea(corners).area;
  for (const Point& corner : corners) {
    const Vector d = corner - face.centre;
    face.second += face.area / 12 * d * d.transpose();
    face.radius = std::max(face.radius, d.norm());
  }
  for (int k = 0; k < 3; ++k) face.points[k] = (corners[k] + face.centre) / 2;
  face.largestFace = face.radius;
  return face;
}

/// Binary tree over faces, cut at the median across the longest side of the centroids' box.
class Tree {
 public:
  struct Node : Cluster {
    std::int32_t first = 0, count = 0;  ///< its faces
    std::int32_t right = -1;            ///< children are the next node and this one; -1 for a leaf
  };

  Tree() = default;
  Tree(const Positions& positions, const Faces& faces, const std::vector<std::int32_t>& members)
      : numbers_(members) {
    if (members.empty()) return;
    std::vector<Face> unsorted(members.size());
    for (std::size_t k = 0; k < members.size(); ++k) {
      unsorted[k] = faceOf(cornersOf(positions, faces, members[k]));
    }
    std::vector<std::int32_t> order(members.size());
    std::iota(order.begin(), order.end(), 0);
    faces_.reserve(members.size());
    cut(unsorted, order.data(), static_cast<std::int32_t>(order.size()));
    for (std::size_t k = 0; k < order.size(); ++k) numbers_[k] = members[order[k]];
  }

  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] const Face& face(std::int32_t k) const { return faces_[k]; }
  [[nodiscard]] std::int32_t number(std::int32_t k) const { return numbers_[k]; }

 private:
  /// Appends a node and all below it, whose faces are order[0] to order[count - 1].
  void cut(const std::vector<Face>& unsorted, std::int32_t* order, std::int32_t count) {
    const std::size_t self = nodes_.size();
    nodes_.emplace_back();
    nodes_[self].first = static_cast<std::int32_t>(faces_.size());
    nodes_[self].count = count;
    if (count <= kLeafFaces) {
      for (std::int32_t k = 0; k < count; ++k) faces_.push_back(unsorted[order[k]]);
    } else {
      Eigen::AlignedBox3d box;
      for (std::int32_t k = 0; k < count; ++k) box.extend(unsorted[order[k]].centre);
      Eigen::Index axis = 0;
      box.sizes().maxCoeff(&axis);
      const std::int32_t half = count / 2;
      std::nth_element(order, order + half, order + count, [&](std::int32_t l, std::int32_t r) {
        const double a = unsorted[l].centre[axis], b = unsorted[r].centre[axis];
        return a != b ? a < b : l < r;
      });
      cut(unsorted, order, half);
      nodes_[self].right = static_cast<std::int32_t>(nodes_.size());
      cut(unsorted, order + half, count - half);
    }
    measure(nodes_[self]);
  }

  void measure(Node& node) const {
    const auto begin = faces_.begin() + node.first, end = begin + node.count;
    Point mean = Point::Zero();
    for (auto face = begin; face != end; ++face) {
      node.area += face->area;
      node.centre += face->area * face->centre;
      mean += face->centre;
      node.largestFace = std::max(node.largestFace, face->radius);
    }
    node.centre = node.area > 0 ? Point(node.centre / node.area) : Point(mean / node.count);
    for (auto face = begin; face != end; ++face) {
      const Vector d = face->centre - node.centre;
      node.second += face->second + face->area * d * d.transpose();
      node.radius = std::max(node.radius, d.norm() + face->radius);
    }
  }

  std::vector<Node> nodes_;
  std::vector<Face> faces_;  // in the order of the leaves
  std::vector<std::int32_t> numbers_;
};

/// Mean of phi over a face and its derivatives by the corners, phi(x) = integral of 1/|x - y|^2.
struct Field {
  double phi = 0;
  std::array<Vector, 3> byCorner{Vector::Zero(), Vector::Zero(), Vector::Zero()};
};

/// What moves one face.
class Target {
 public:
  Target(const Face& face, std::span<const std::int32_t> touching,
         const MultipoleTreeOptions& options)
      : face_(face), touching_(touching), options_(options) {
    moments_ = face.area > 0 ? Eigen::Matrix3d(face.second / face.area) : Eigen::Matrix3d::Zero();
  }

  [[nodiscard]] Field fieldOf(const Tree& tree) const {
    Field field;
    if (!tree.nodes().empty()) add(tree, 0, field);
    return field;
  }

 private:
  void add(const Tree& tree, std::int32_t n, Field& field) const {
    const Tree::Node& node = tree.nodes()[n];
    if (isFar(node)) {
      addFar(node, field);
    } else if (node.right >= 0) {
      add(tree, n + 1, field);
      add(tree, node.right, field);
    } else {
      for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
        if (std::binary_search(touching_.begin(), touching_.end(), tree.number(k))) continue;
        const Face& source = tree.face(k);
        if (isFar(source)) {
          addFar(source, field);
        } else if ((source.centre - face_.centre).norm() >=
                   options_.nearRatio * (source.radius + face_.radius)) {
          addByPoints(source, field);
        } else {
          addNear(source, field);
        }
      }
    }
  }

  /// True if moments are enough, and none of its faces is near.
  [[nodiscard]] bool isFar(const Cluster& c) const {
    const double reach = std::max(c.radius / options_.opening, kCarry * c.largestFace);
    const double clear =
        std::max(reach + face_.radius, c.radius + (options_.nearRatio - 1) * c.largestFace +
                                           options_.nearRatio * face_.radius);
    return (c.centre - face_.centre).squaredNorm() > clear * clear;
  }

  /// Both sides by their second moments: f = m / r^2 + half the contraction of its second
  /// derivatives with Q, the cluster's moments and those that its mass has by the face's extent.
  void addFar(const Cluster& c, Field& field) const {
    const double m = c.area;
    const Vector r = face_.centre - c.centre;
    const double s = 1 / r.squaredNorm();
    const Eigen::Matrix3d q = c.second + m * moments_;
    const Vector qr = q * r;
    const double along = s * r.dot(qr), trace = q.trace();
    const double radial = s * s * (-2 * m + s * (4 * trace - 24 * along));
    field.phi += s * (m + s * (4 * along - trace));
    const Vector gradient = radial * r + 8 * s * s * s * qr;
    for (int k = 0; k < 3; ++k) {
      const Vector d = face_.corners[k] - face_.centre;
      // The second derivatives, of the mass alone, act by how the corner bends the moments.
      field.byCorner[k] += gradient / 3 + radial / 12 * (d - 4 * s * r.dot(d) * r);
    }
  }

  void addByPoints(const Face& source, Field& field) const {
    Vector total = Vector::Zero();
    for (int k = 0; k < 3; ++k) {
      Vector gradient = Vector::Zero();
      for (const Point& y : source.points) {
        const Vector z = face_.points[k] - y;
        const double s = 1 / z.squaredNorm();
        field.phi += source.area / 9 * s;
        gradient -= source.area / 4.5 * s * s * z;
      }
      total += gradient;
      field.byCorner[k] += gradient / 2;
    }
    for (Vector& by : field.byCorner) by += total / 6;
  }

  /// PairIntegral multiplies the mean by both areas; its derivatives hold those of the area.
  void addNear(const Face& source, Field& field) const {
    const AreaGradient area = areaGradient(face_.corners);
    if (!(area.area > 0)) return;
    const PairIntegral pair = integrateApart(face_.corners, source.corners, PairAccuracy::Coarse);
    const double phi = pair.value / area.area;
    field.phi += phi;
    for (int k = 0; k < 3; ++k) {
      field.byCorner[k] += (pair.byS[k] - phi * area.byCorner[k]) / area.area;
    }
  }

  const Face& face_;
  std::span<const std::int32_t> touching_;
  const MultipoleTreeOptions& options_;
  Eigen::Matrix3d moments_;  // second moments of the face over its area, mm^2
};

}  // namespace

struct MultipoleTree::State {
  State(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
        const MultipoleTreeOptions& chosen)
      : set(mesh, vertexMoves), options(chosen), fixed(mesh.positions, set.faces, set.fixed) {}

  MovingSet set;
  MultipoleTreeOptions options;
  Tree fixed;
};

MultipoleTree::MultipoleTree(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
                             const MultipoleTreeOptions& options) {
  if (!(options.opening > 0 && options.opening < 1)) {
    throw InvalidInput("knot energy: opening is " + std::to_string(options.opening) +
                       "; it must lie between 0 and 1");
  }
  if (!(options.nearRatio >= 1)) {
    throw InvalidInput("knot energy: near ratio is " + std::to_string(options.nearRatio) +
                       "; it must be at least 1");
  }
  state_ = std::make_unique<State>(mesh, vertexMoves, options);
}

MultipoleTree::~MultipoleTree() = default;

KnotValue MultipoleTree::evaluate(const Positions& positions) const {
  const MovingSet& set = state_->set;
  set.requireVertexCount(positions);
  const Tree moving(positions, set.faces, set.moving);
  std::vector<FaceForce> forces(set.moving.size());
  parallelFor(forces.size(), 16, [&](std::size_t k) {
    const Face face = faceOf(cornersOf(positions, set.faces, set.moving[k]));
    const Target target(face, set.touching(k), state_->options);
    const Field byMoving = target.fieldOf(moving), byFixed = target.fieldOf(state_->fixed);
    const double phi = byMoving.phi + byFixed.phi;
    const AreaGradient area = areaGradient(face.corners);
    forces[k].value = area.area * (phi + byFixed.phi);
    for (int c = 0; c < 3; ++c) {
      forces[k].byCorner[c] =
          2 * area.area * (byMoving.byCorner[c] + byFixed.byCorner[c]) + 2 * phi * area.byCorner[c];
    }
  });
  return assemble(set, positions, forces, adjacentPairs(set, positions, PairAccuracy::Coarse));
}

}  // namespace explica::repulsion
