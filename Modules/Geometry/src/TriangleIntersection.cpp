// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/TriangleIntersection.h"

#include "Explica/Geometry/Predicates.h"

#include <algorithm>

namespace explica::geometry {
namespace {

Eigen::Vector2d dropAxis(const Point& p, int axis) {
  return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

/// True if c, known to be on the line through a and b, lies between them, ends included.
bool between(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return std::min(a.x(), b.x()) <= c.x() && c.x() <= std::max(a.x(), b.x()) &&
         std::min(a.y(), b.y()) <= c.y() && c.y() <= std::max(a.y(), b.y());
}

bool segmentsMeet(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& a,
                  const Eigen::Vector2d& b) {
  const int pSide = orientation(a, b, p), qSide = orientation(a, b, q);
  const int aSide = orientation(p, q, a), bSide = orientation(p, q, b);
  if (pSide * qSide < 0 && aSide * bSide < 0) return true;
  return (pSide == 0 && between(a, b, p)) || (qSide == 0 && between(a, b, q)) ||
         (aSide == 0 && between(p, q, a)) || (bSide == 0 && between(p, q, b));
}

bool segmentsMeet(const Point& p, const Point& q, const Point& a, const Point& b) {
  if (orientation(p, q, a, b) != 0) return false;
  // The four points are coplanar.  A projection along an axis is faithful if it keeps them from
  // becoming collinear; if all three make them so, they are collinear in space, and any projection
  // in which the meeting is seen by all three is decisive.
  for (int axis = 0; axis < 3; ++axis) {
    const auto p2 = dropAxis(p, axis), q2 = dropAxis(q, axis);
    const auto a2 = dropAxis(a, axis), b2 = dropAxis(b, axis);
    if (orientation(p2, q2, a2) != 0 || orientation(p2, q2, b2) != 0 ||
        orientation(a2, b2, p2) != 0 || orientation(a2, b2, q2) != 0) {
      return segmentsMeet(p2, q2, a2, b2);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (std::max(p[axis], q[axis]) < std::min(a[axis], b[axis]) ||
        std::max(a[axis], b[axis]) < std::min(p[axis], q[axis])) {
      return false;
    }
  }
  return true;
}

/// Axis along which the triangle projects without collapsing, or -1 if it is degenerate.
int faithfulAxis(const Triangle& t) {
  for (int axis = 0; axis < 3; ++axis) {
    if (orientation(dropAxis(t[0], axis), dropAxis(t[1], axis), dropAxis(t[2], axis)) != 0) {
      return axis;
    }
  }
  return -1;
}

bool meetsAnEdge(const Point& p, const Point& q, const Triangle& t) {
  return segmentsMeet(p, q, t[0], t[1]) || segmentsMeet(p, q, t[1], t[2]) ||
         segmentsMeet(p, q, t[2], t[0]);
}

bool segmentMeetsTriangle(const Point& p, const Point& q, const Triangle& t) {
  const int pSide = orientation(t[0], t[1], t[2], p);
  const int qSide = orientation(t[0], t[1], t[2], q);
  if (pSide * qSide > 0) return false;
  if (pSide != 0 || qSide != 0) {
    const int ab = orientation(p, q, t[0], t[1]);
    const int bc = orientation(p, q, t[1], t[2]);
    const int ca = orientation(p, q, t[2], t[0]);
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
  }
  if (meetsAnEdge(p, q, t)) return true;
  const int axis = faithfulAxis(t);
  if (axis < 0) return false;
  const auto p2 = dropAxis(p, axis);
  const auto a = dropAxis(t[0], axis), b = dropAxis(t[1], axis), c = dropAxis(t[2], axis);
  const int ab = orientation(a, b, p2), bc = orientation(b, c, p2), ca = orientation(c, a, p2);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// True if all corners of t lie strictly on one side of the plane of s.
bool onOneSide(const Triangle& s, const Triangle& t) {
  const int first = orientation(s[0], s[1], s[2], t[0]);
  return first != 0 && orientation(s[0], s[1], s[2], t[1]) == first &&
         orientation(s[0], s[1], s[2], t[2]) == first;
}

}  // namespace

bool trianglesIntersect(const Triangle& s, const Triangle& t) {
  if (onOneSide(s, t) || onOneSide(t, s)) return false;
  for (int k = 0; k < 3; ++k) {
    if (segmentMeetsTriangle(s[k], s[(k + 1) % 3], t) ||
        segmentMeetsTriangle(t[k], t[(k + 1) % 3], s)) {
      return true;
    }
  }
  return false;
}

bool trianglesSharingVertexIntersect(const Point& p, const Point& a, const Point& b, const Point& c,
                                     const Point& d) {
  // The common set is convex and holds p: a further point of it lies on a ray from p that leaves
  // one of the triangles, inside the other, through the edge opposite p.
  return segmentMeetsTriangle(a, b, {p, c, d}) || segmentMeetsTriangle(c, d, {p, a, b});
}

bool trianglesSharingEdgeIntersect(const Point& p, const Point& q, const Point& a, const Point& b) {
  if (orientation(p, q, a, b) != 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const auto p2 = dropAxis(p, axis), q2 = dropAxis(q, axis);
    const int aSide = orientation(p2, q2, dropAxis(a, axis));
    const int bSide = orientation(p2, q2, dropAxis(b, axis));
    if (aSide != 0 && bSide != 0) return aSide == bSide;
  }
  return false;
}

}  // namespace explica::geometry
