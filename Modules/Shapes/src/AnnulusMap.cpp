// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/AnnulusMap.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::shapes {
namespace {

using Complex = std::complex<double>;

constexpr int kCentreLattice = 32;    // candidates a side for the point that the hole encloses
constexpr double kCentreShare = 0.5;  // of the best candidate's distance: the centroid is kept then
// Half a piece's length over its distance: below, the series' four terms are exact to rounding.
constexpr double kFar = 0.03;
constexpr double kCloseTo = 1e-13;  // of the radius: a point this near to a node is that node

/// Without the care for infinities that the operator takes, and its cost.
Complex product(const Complex& a, const Complex& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

Complex complexOf(const planar::Point2& p) {
  return {p.x(), p.y()};
}

/// A polygon as the map takes it: counter-clockwise and simple.
planar::Curve usable(planar::Curve curve, const char* name) {
  if (!curve.closed) throw InvalidInput(std::string(name) + " boundary of the annulus: not closed");
  planar::requireUsable(curve);
  if (planar::signedArea(curve.positions) < 0) {
    curve.positions = curve.positions.colwise().reverse().eval();
  }
  if (!planar::intersectingEdges(curve).empty()) {
    throw InvalidInput(std::string(name) + " boundary of the annulus: its edges cross");
  }
  return curve;
}

/// A point well within a polygon: its centroid if that is.
planar::Point2 pointWithin(const planar::Curve& curve) {
  const planar::Point2 low = curve.positions.colwise().minCoeff().transpose();
  const planar::Point2 high = curve.positions.colwise().maxCoeff().transpose();
  const auto depth = [&](const planar::Point2& p) {
    return planar::encloses(curve, p) ? planar::distanceTo(curve, p) : -1.0;
  };
  planar::Point2 best = low;
  double most = -1;
  for (int j = 0; j < kCentreLattice; ++j) {
    for (int i = 0; i < kCentreLattice; ++i) {
      const planar::Point2 share((i + 0.5) / kCentreLattice, (j + 0.5) / kCentreLattice);
      const planar::Point2 p = low + share.cwiseProduct(high - low);
      const double d = depth(p);
      if (d > most) {
        most = d;
        best = p;
      }
    }
  }
  planar::Point2 centroid = planar::centroidOf(curve, planar::wholeRegion(curve));
  if (depth(centroid) > kCentreShare * most) return centroid;
  if (most < 0) throw InvalidInput("inner boundary of the annulus: it encloses next to nothing");
  return best;
}

/// True if an edge of one polygon meets an edge of the other.
bool polygonsMeet(const planar::Curve& a, const planar::Curve& b) {
  for (int i = 0; i < a.edgeCount(); ++i) {
    const planar::Point2 p = a.point(i);
    const planar::Point2 q = a.point(a.next(i));
    const planar::Point2 low = p.cwiseMin(q);
    const planar::Point2 high = p.cwiseMax(q);
    for (int j = 0; j < b.edgeCount(); ++j) {
      const planar::Point2 r = b.point(j);
      const planar::Point2 s = b.point(b.next(j));
      if ((r.cwiseMax(s).array() < low.array()).any()) continue;
      if ((r.cwiseMin(s).array() > high.array()).any()) continue;
      if (planar::segmentsMeet(p, q, r, s)) return true;
    }
  }
  return false;
}

}  // namespace

AnnulusMap::AnnulusMap(const planar::Curve& inner, const planar::Curve& outer, int pieces)
    : inner_(usable(inner, "inner")), outer_(usable(outer, "outer")) {
  if (pieces < 8) throw InvalidInput("annulus: at least 8 pieces of each boundary are needed");
  if (polygonsMeet(inner_, outer_)) throw InvalidInput("annulus: its two boundaries meet");
  if (!planar::encloses(outer_, inner_.point(0))) {
    throw InvalidInput("annulus: the inner boundary does not lie within the outer one");
  }
  centre_ = complexOf(pointWithin(inner_));
  outerRadius_ = std::sqrt(planar::signedArea(outer_.positions) / kPi);
  addBoundary(outer_, pieces, false);
  outerNodes_ = nodes_.size();
  addBoundary(inner_, pieces, true);
  solve();
}

double AnnulusMap::meanWidth() const {
  const double area = planar::signedArea(outer_.positions) - planar::signedArea(inner_.positions);
  return 2 * area / (planar::edgeLengths(outer_).sum() + planar::edgeLengths(inner_).sum());
}

void AnnulusMap::addBoundary(const planar::Curve& curve, int pieces, bool reversed) {
  const double longest = planar::edgeLengths(curve).sum() / pieces;
  const int first = static_cast<int>(nodes_.size());
  const int n = curve.vertexCount();
  for (int k = 0; k < n; ++k) {
    const planar::Point2 a = curve.point(reversed ? n - 1 - k : k);
    const planar::Point2 b = curve.point(reversed ? (2 * n - 2 - k) % n : (k + 1) % n);
    const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / longest)));
    for (int part = 0; part < parts; ++part) {
      nodes_.push_back(complexOf(a + static_cast<double>(part) / parts * (b - a)));
    }
  }
  const int end = static_cast<int>(nodes_.size());
  for (int v = first; v < end; ++v) {
    const int next = v + 1 == end ? first : v + 1;
    pieces_.push_back({v, next, 1.0 / (nodes_[next] - nodes_[v])});
  }
}

AnnulusMap::Complex AnnulusMap::logarithmOf(const Piece& piece, Complex z) const {
  const Complex a = nodes_[piece.from] - z;
  const Complex b = nodes_[piece.to] - z;
  const Complex sum = a + b;
  const Complex step = b - a;
  const double squareSum = std::norm(sum);
  if (std::norm(step) < kFar * kFar * squareSum) {
    // 2 artanh(d), d = step / sum, by its series in q = d^2.
    const Complex d = product(step, std::conj(sum)) / squareSum;
    const Complex q = product(d, d);
    Complex series = 1 / 7.0 + q * (1 / 9.0);
    series = 1 / 5.0 + product(q, series);
    series = 1 / 3.0 + product(q, series);
    return 2.0 * (d + product(d, product(q, series)));
  }
  return {0.5 * std::log(std::norm(b) / std::norm(a)),
          std::atan2(a.real() * b.imag() - a.imag() * b.real(),
                     a.real() * b.real() + a.imag() * b.imag())};
}

AnnulusMap::Weights AnnulusMap::weightsOf(const Piece& piece, Complex z) const {
  const Complex along = logarithmOf(piece, z) * piece.inverse;
  return {along * (nodes_[piece.to] - z), along * (z - nodes_[piece.from])};
}

void AnnulusMap::solve() {
  // With f = u + i v, u known up to ln(r/R) on the inner boundary, Cauchy's formula at node j less
  // f_j times that of the constant function reads
  //
  //     S_j = sum over pieces of L (f(z_j) - f_j) = 0,
  //
  // in which pieces that end at j drop out.  Re S_j = 0 is an equation of second kind for v: its
  // kernel is the angles under which pieces are seen.  It leaves v's mean open (set to 0 on the
  // outer boundary; the slack in exchange vanishes with the pieces' length), and a constant on the
  // inner boundary does not enter it: that one follows from Im S_j = 0.
  const auto n = static_cast<Eigen::Index>(nodes_.size());
  Eigen::VectorXd u(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    u[k] = std::log(outerRadius_) - std::log(std::abs(nodes_[k] - centre_));
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1);
  parallelFor(nodes_.size(), 16, [&](std::size_t row) {
    const auto j = static_cast<Eigen::Index>(row);
    for (const Piece& piece : pieces_) {
      if (piece.from == j || piece.to == j) continue;
      const Weights w = weightsOf(piece, nodes_[row]);
      matrix(j, piece.from) -= w.from.imag();
      matrix(j, piece.to) -= w.to.imag();
      matrix(j, j) += w.sum().imag();
      right[j] -= w.from.real() * (u[piece.from] - u[j]) + w.to.real() * (u[piece.to] - u[j]);
    }
    matrix(j, n) = 1;
  });
  for (std::size_t p = 0; p < outerNodes_; ++p) {
    const Piece& piece = pieces_[p];
    const double half = 0.5 * std::abs(nodes_[piece.to] - nodes_[piece.from]) / outerRadius_;
    matrix(n, piece.from) += half;
    matrix(n, piece.to) += half;
  }
  const Eigen::VectorXd v = matrix.partialPivLu().solve(right);

  // S_j of an inner node falls by 2 pi i for each unit that u rises on the inner boundary.
  double sum = 0;
  for (std::size_t j = outerNodes_; j < nodes_.size(); ++j) {
    const Complex own(u[static_cast<Eigen::Index>(j)], v[static_cast<Eigen::Index>(j)]);
    for (const Piece& piece : pieces_) {
      if (piece.from == static_cast<int>(j) || piece.to == static_cast<int>(j)) continue;
      const Weights w = weightsOf(piece, nodes_[j]);
      sum += (w.from * (Complex(u[piece.from], v[piece.from]) - own) +
              w.to * (Complex(u[piece.to], v[piece.to]) - own))
                 .imag();
    }
  }
  const double rise = sum / (2 * kPi * static_cast<double>(nodes_.size() - outerNodes_));
  if (!v.allFinite() || !(rise < 0)) {
    throw InvalidInput("annulus: its boundaries are too near to each other for " +
                       std::to_string(n) + " nodes");
  }
  innerRadius_ = outerRadius_ * std::exp(rise);
  values_.resize(nodes_.size());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    values_[k] = {u[at] + (k < outerNodes_ ? 0 : rise), v[at]};
  }
}

AnnulusSide AnnulusMap::sideOf(const planar::Point2& point) const {
  if (!planar::encloses(outer_, point)) return AnnulusSide::Beyond;
  return planar::encloses(inner_, point) ? AnnulusSide::Enclosed : AnnulusSide::Inside;
}

AnnulusMap::Complex AnnulusMap::nearestValue(Complex z, Complex& nearest) const {
  double least = kInfinity;
  Complex value;
  for (const Piece& piece : pieces_) {
    const Complex a = nodes_[piece.from];
    const Complex along = nodes_[piece.to] - a;
    const double share =
        std::clamp((std::conj(along) * (z - a)).real() / std::norm(along), 0.0, 1.0);
    const double distance = std::norm(z - a - share * along);
    if (distance < least) {
      least = distance;
      nearest = a + share * along;
      value = (1 - share) * values_[piece.from] + share * values_[piece.to];
    }
  }
  return value;
}

planar::Point2 AnnulusMap::operator()(const planar::Point2& point) const {
  Complex z = complexOf(point);
  Complex sum = 0;
  Complex weight = 0;
  bool atNode = false;
  const double close = kCloseTo * outerRadius_;
  for (const Piece& piece : pieces_) {
    if (std::norm(nodes_[piece.from] - z) < close * close) {
      atNode = true;
      break;
    }
    const Complex logarithm = logarithmOf(piece, z);
    sum += product(product(logarithm, piece.inverse),
                   product(nodes_[piece.to] - z, values_[piece.from]) +
                       product(z - nodes_[piece.from], values_[piece.to]));
    weight += logarithm;
  }
  // The weights add up to 2 pi i inside and to 0 elsewhere.
  const Complex f = !atNode && weight.imag() > kPi ? sum / weight : nearestValue(z, z);
  const Complex turn = {std::cos(f.imag()), std::sin(f.imag())};
  const Complex w = (z - centre_) * (std::exp(f.real()) * turn);
  return {w.real(), w.imag()};
}

}  // namespace explica::shapes
