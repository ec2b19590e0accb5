// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonKnotEnergy.h"

#include "EdgeTree.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Segment.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::planar {
namespace {

// Sine of the angle between two lines, and distance of their crossing in edge lengths, from which
// the closed form loses about 4 of its 16 digits in the gradient: then quadrature takes over.
constexpr double kLeastSine = 1e-3;
constexpr double kFarCrossing = 300;

double cross(const Point2& a, const Point2& b) {
  return a.x() * b.y() - a.y() * b.x();
}
Point2 turnedLeft(const Point2& v) {
  return {-v.y(), v.x()};
}

/// Potential at `ra`, `rb` from the ends of a uniform unit charge of length l.
double potential(double ra, double rb, double l) {
  return std::log((ra + rb + l) / (ra + rb - l));
}

/// Ten-point Gauss rule on [-1, 1]: positive nodes and weights.
constexpr std::array<double, 5> kNodes = {0.14887433898163122, 0.43339539412924719,
                                          0.67940956829902441, 0.86506336668898451,
                                          0.97390652851717172};
constexpr std::array<double, 5> kWeights = {0.29552422471475287, 0.26926671930999636,
                                            0.21908636251598204, 0.14945134915058059,
                                            0.06667134430868814};
// A panel is halved until it is no longer than its middle is away from the other edge; the error
// of the ten-point rule is then below 1e-10 of the panel's share.
constexpr int kMostHalvings = 60;

/// Adds the integral over x in panel [u0, u1] of edge (a, b) of the potential of edge (c, d).
void addPanel(const std::array<Point2, 4>& p, double u0, double u1, int halvings,
              EdgePairIntegral& sum) {
  const Point2 ab = p[1] - p[0];
  const double length = ab.norm();
  const Point2 tangent = ab / length;
  const Point2 cd = p[3] - p[2];
  const double other = cd.norm();
  const Point2 middle = p[0] + 0.5 * (u0 + u1) * ab;
  if (halvings > 0 && (u1 - u0) * length > distanceToSegment(middle, p[2], p[3])) {
    const double half = 0.5 * (u0 + u1);
    addPanel(p, u0, half, halvings - 1, sum);
    addPanel(p, half, u1, halvings - 1, sum);
    return;
  }
  for (std::size_t k = 0; k < 2 * kNodes.size(); ++k) {
    const double node = k % 2 == 0 ? kNodes[k / 2] : -kNodes[k / 2];
    const double u = 0.5 * (u0 + u1) + 0.5 * (u1 - u0) * node;
    const double weight = 0.5 * (u1 - u0) * kWeights[k / 2];
    const Point2 x = p[0] + u * ab;
    const Point2 xc = x - p[2];
    const Point2 xd = x - p[3];
    const double rc = xc.norm();
    const double rd = xd.norm();
    const double phi = potential(rc, rd, other);
    // d phi = 2 ((rc + rd) d|cd| - |cd| d(rc + rd)) / ((rc + rd)^2 - |cd|^2).
    const double scale = 2 / ((rc + rd + other) * (rc + rd - other));
    const Point2 phiByX = -scale * other * (xc / rc + xd / rd);
    const Point2 phiByC = scale * (-(rc + rd) * cd / other + other * xc / rc);
    const Point2 phiByD = scale * ((rc + rd) * cd / other + other * xd / rd);
    sum.value += weight * length * phi;
    sum.gradient[0] += weight * (length * (1 - u) * phiByX - phi * tangent);
    sum.gradient[1] += weight * (length * u * phiByX + phi * tangent);
    sum.gradient[2] += weight * length * phiByC;
    sum.gradient[3] += weight * length * phiByD;
  }
}

/// Charge and second moments of edges, seen from far.
EdgePairIntegral farIntegral(const Point2& a, const Point2& b, const EdgeTree::Node& cluster) {
  // Two Gauss points on the near edge.
  const Point2 ab = b - a;
  const double length = ab.norm();
  const Point2 tangent = ab / length;
  EdgePairIntegral result;
  for (const double node : {-0.57735026918962576, 0.57735026918962576}) {
    const double u = 0.5 + 0.5 * node;
    const Point2 r = a + u * ab - cluster.centre;
    const double inverse = 1 / r.norm();
    const double inverse2 = inverse * inverse;
    const double inverse3 = inverse2 * inverse;
    const Point2 mr = cluster.moments * r;
    const double rmr = r.dot(mr);
    const double trace = cluster.moments.trace();
    // 1/|r - y| to second order in y: 1/r + (3 r'Mr - r^2 tr M) / (2 r^5).
    const double phi = cluster.charge * inverse + 0.5 * inverse3 * (3 * rmr * inverse2 - trace);
    const Point2 phiByX = -cluster.charge * inverse3 * r +
                          inverse3 * inverse2 * (3 * mr + 1.5 * trace * r) -
                          7.5 * inverse3 * inverse2 * inverse2 * rmr * r;
    result.value += 0.5 * length * phi;
    result.gradient[0] += 0.5 * (length * (1 - u) * phiByX - phi * tangent);
    result.gradient[1] += 0.5 * (length * u * phiByX + phi * tangent);
  }
  return result;
}

/// One edge's own part and its share of every pair.
struct EdgeSum {
  double value = 0;
  Point2 byStart = Point2::Zero();
  Point2 byEnd = Point2::Zero();
  std::size_t pairs = 0;
};

/// Adds the pair (i, j) to edge i: half the value if both move, since j adds the other half.
void addPair(const Curve& curve, int i, int j, bool bothMove, EdgeSum& sum) {
  const Point2 a = curve.point(i);
  const Point2 b = curve.point(curve.next(i));
  const Point2 c = curve.point(j);
  const Point2 d = curve.point(curve.next(j));
  EdgePairIntegral pair;
  if (curve.next(i) == j) {
    // The shared vertex's gradient is counted once, with the edge that starts there.
    pair = joinedEdgesIntegral(a, b, d);
    sum.byStart += pair.gradient[0];
  } else if (curve.next(j) == i) {
    pair = joinedEdgesIntegral(c, d, b);
    sum.byStart += pair.gradient[1];
    sum.byEnd += pair.gradient[3];
  } else {
    pair = apartEdgesIntegral(a, b, c, d);
    sum.byStart += pair.gradient[0];
    sum.byEnd += pair.gradient[1];
  }
  sum.value += bothMove ? 0.5 * pair.value : pair.value;
  ++sum.pairs;
}

void addSelf(const Curve& curve, int e, EdgeSum& sum) {
  const Point2 t = curve.point(curve.next(e)) - curve.point(e);
  const double length = t.norm();
  sum.value += length * std::log(length) - length;
  const Point2 gradient = std::log(length) * t / length;
  sum.byStart -= gradient;
  sum.byEnd += gradient;
}

void addFar(const Curve& curve, int e, const EdgeTree::Node& cluster, EdgeSum& sum) {
  const EdgePairIntegral far = farIntegral(curve.point(e), curve.point(curve.next(e)), cluster);
  sum.value += (cluster.anyMoves ? 0.5 : 1.0) * far.value;
  sum.byStart += far.gradient[0];
  sum.byEnd += far.gradient[1];
}

}  // namespace

EdgePairIntegral apartEdgesQuadrature(const Point2& a, const Point2& b, const Point2& c,
                                      const Point2& d) {
  EdgePairIntegral sum;
  addPanel({a, b, c, d}, 0, 1, kMostHalvings, sum);
  return sum;
}

EdgePairIntegral apartEdgesIntegral(const Point2& a, const Point2& b, const Point2& c,
                                    const Point2& d) {
  const double lengthS = (b - a).norm();
  const double lengthT = (d - c).norm();
  const Point2 u = (b - a) / lengthS;
  const Point2 w = (d - c) / lengthT;
  const double sine = cross(u, w);
  if (std::abs(sine) < kLeastSine) return apartEdgesQuadrature(a, b, c, d);
  const Point2 e = a - c;
  const double sa = cross(e, w) / sine;
  const double tc = cross(e, u) / sine;
  if (std::max(std::abs(sa), std::abs(tc)) > kFarCrossing * std::min(lengthS, lengthT)) {
    return apartEdgesQuadrature(a, b, c, d);
  }
  const double sb = sa + lengthS;
  const double td = tc + lengthT;
  const double rac = e.norm();
  const double rad = (a - d).norm();
  const double rbc = (b - c).norm();
  const double rbd = (b - d).norm();
  const double phiA = potential(rac, rad, lengthT);
  const double phiB = potential(rbc, rbd, lengthT);
  const double psiC = potential(rac, rbc, lengthS);
  const double psiD = potential(rad, rbd, lengthS);

  EdgePairIntegral result{.value = sb * phiB - sa * phiA + td * psiD - tc * psiC};

  // dG/ds and dG/dt are the potentials at the ends; dG/d(u.w) = -R / sine^2 and terms that cancel.
  const double bySa = phiB - phiA;
  const double byTc = psiD - psiC;
  const double byCosine = -(rbd - rad - rbc + rac) / (sine * sine);
  const double bySine = -(bySa * sa + byTc * tc) / sine;
  const Point2 byE = -(bySa * turnedLeft(w) + byTc * turnedLeft(u)) / sine;
  Point2 byU = byTc / sine * turnedLeft(e) - bySine * turnedLeft(w) + byCosine * w;
  Point2 byW = bySa / sine * turnedLeft(e) + bySine * turnedLeft(u) + byCosine * u;
  const Point2 byAB = (byU - u.dot(byU) * u) / lengthS + phiB * u;
  const Point2 byCD = (byW - w.dot(byW) * w) / lengthT + psiD * w;
  result.gradient = {byE - byAB, byAB, -byE - byCD, byCD};
  return result;
}

EdgePairIntegral joinedEdgesIntegral(const Point2& a, const Point2& b, const Point2& d) {
  const Point2 ba = a - b;
  const Point2 bd = d - b;
  const Point2 ad = d - a;
  const double s = ba.norm();
  const double t = bd.norm();
  const double r = ad.norm();
  const double all = s + t + r;
  // r - |s - t| without cancellation: r^2 - (s - t)^2 = 2 (s t - ba . bd).
  const double product = 2 * (s * t - ba.dot(bd));
  double withS = r + s - t;
  double withT = r + t - s;
  if (s < t) {
    withS = product / withT;
  } else {
    withT = product / withS;
  }
  EdgePairIntegral result;
  const double logS = std::log(all / withS);
  const double logT = std::log(all / withT);
  result.value = s * logS + t * logT;
  const double byS = logS + s * (1 / all - 1 / withS) + t * (1 / all + 1 / withT);
  const double byT = logT + t * (1 / all - 1 / withT) + s * (1 / all + 1 / withS);
  const double byR = s * (1 / all - 1 / withS) + t * (1 / all - 1 / withT);
  result.gradient[0] = byS * ba / s - byR * ad / r;
  result.gradient[3] = byT * bd / t + byR * ad / r;
  result.gradient[1] = -byS * ba / s - byT * bd / t;
  return result;
}

PolygonKnotEnergy::PolygonKnotEnergy(PolygonKnot method, const Curve& curve,
                                     std::vector<bool> moving, double openingRatio)
    : method_(method), closed_(curve.closed), moving_(std::move(moving)) {
  if (static_cast<int>(moving_.size()) != curve.vertexCount()) {
    throw InvalidInput("knot energy: " + std::to_string(moving_.size()) + " marks for " +
                       std::to_string(curve.vertexCount()) + " vertices, one each is needed");
  }
  if (!(openingRatio > 0 && openingRatio < 1)) {
    throw InvalidInput("knot energy: the opening ratio must lie between 0 and 1");
  }
  constexpr double kMostPairs = 4e6;  // a third of a second on one processor
  const auto movers = static_cast<double>(std::ranges::count(moving_, true));
  const bool many = movers * curve.edgeCount() > kMostPairs;
  const bool far = method == PolygonKnot::Tree || (method == PolygonKnot::Auto && many);
  openingRatio_ = far ? openingRatio : 0;
}

PolygonKnotValue PolygonKnotEnergy::evaluate(const Positions2& positions) const {
  constexpr std::size_t kPairsPerTask = 8192;  // about a millisecond: less is not worth a thread
  PolygonKnotValue result{.gradient = Positions2::Zero(positions.rows(), 2)};
  if (method_ == PolygonKnot::Off) return result;
  const Curve curve{positions, closed_};
  const auto moves = [&](int e) { return moving_[e] || moving_[curve.next(e)]; };
  const EdgeTree tree(curve, moves);
  const auto n = static_cast<std::size_t>(curve.edgeCount());
  std::vector<EdgeSum> sums(n);
  parallelFor(n, kPairsPerTask / n + 1, [&](std::size_t index) {
    const int i = static_cast<int>(index);
    if (!moves(i)) return;
    EdgeSum& sum = sums[index];
    addSelf(curve, i, sum);
    tree.traverse(
        curve.point(i), curve.point(curve.next(i)), openingRatio_,
        [&](const EdgeTree::Node& cluster) { addFar(curve, i, cluster, sum); },
        [&](int j) {
          if (j != i) addPair(curve, i, j, moves(j), sum);
        });
  });
  for (int e = 0; e < curve.edgeCount(); ++e) {
    result.value += sums[e].value;
    result.pairs += sums[e].pairs;
    result.gradient.row(e) += sums[e].byStart.transpose();
    result.gradient.row(curve.next(e)) += sums[e].byEnd.transpose();
  }
  for (int v = 0; v < curve.vertexCount(); ++v) {
    if (!moving_[v]) result.gradient.row(v).setZero();
  }
  return result;
}

}  // namespace explica::planar
