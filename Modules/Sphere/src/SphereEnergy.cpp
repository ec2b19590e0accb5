// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/SphereEnergy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::sphere {
namespace {

constexpr std::size_t kFacesATask = 1024;  // some 50 microseconds a task

std::array<Point, 3> cornersOf(const Positions& sphere, const Faces& faces, Eigen::Index f) {
  return {sphere.row(faces(f, 0)).transpose(), sphere.row(faces(f, 1)).transpose(),
          sphere.row(faces(f, 2)).transpose()};
}

/// [y] with [y] x = y cross x.
Eigen::Matrix3d crossMatrix(const Vector& y) {
  Eigen::Matrix3d m;
  m << 0, -y.z(), y.y(), y.z(), 0, -y.x(), -y.y(), y.x(), 0;
  return m;
}

double determinant(const Vector& a, const Vector& b, const Vector& c) {
  return a.dot(b.cross(c));
}

}  // namespace

SphereDensity sphereDensity(double s, double d, const MapWeights& weights) {
  if (!(d > 0)) return {kInfinity};
  const double w = weights.balance, e = weights.corner, inverse = 1 / d;
  const double h = (d - inverse) / 2, r = std::hypot(h, e), hD = (1 + inverse * inverse) / 2;
  SphereDensity psi;
  psi.value = s * inverse / 2 + w * r;
  psi.dS = inverse / 2;
  psi.dD = -s * inverse * inverse / 2 + w * h / r * hD;
  psi.dSD = -inverse * inverse / 2;
  psi.dDD = (s - w * h / r) * inverse * inverse * inverse + w * e * e * hD * hD / (r * r * r);
  if (weights.barrier > 0) {
    const double m = weights.mostAreal * std::log(2.0), l = std::log(d) / m;
    const double room = 1 - l * l;
    if (!(room > 0)) return {kInfinity};
    const double slope = 2 * l / room / m;  // by log d
    const double bend = (2 / room + 4 * l * l / (room * room)) / (m * m);
    psi.value -= weights.barrier * std::log(room);
    psi.dD += weights.barrier * slope * inverse;
    psi.dDD += weights.barrier * (bend - slope) * inverse * inverse;
  }
  if (weights.symmetric) {
    const double share = (1 + d) / 2;
    psi.dDD = share * psi.dDD + psi.dD;
    psi.dSD = share * psi.dSD + psi.dS / 2;
    psi.dD = share * psi.dD + psi.value / 2;
    psi.dS *= share;
    psi.value *= share;
  }
  return psi;
}

double convexDD(const SphereDensity& psi, double squaredJacobian) {
  return std::max(psi.dDD, 2 * squaredJacobian * psi.dSD * psi.dSD / psi.dS);
}

SphereFace sphereFace(const RestFace& rest, const std::array<Point, 3>& y) {
  Vector jx = Vector::Zero(), jy = Vector::Zero();
  for (int k = 0; k < 3; ++k) {
    jx += rest.gradient[k].real() * y[k];
    jy += rest.gradient[k].imag() * y[k];
  }
  SphereFace face;
  face.squaredJacobian = jx.squaredNorm() + jy.squaredNorm();
  for (int k = 0; k < 3; ++k) {
    face.gradientS[k] = 2 * (rest.gradient[k].real() * jx + rest.gradient[k].imag() * jy);
    face.gradientD[k] = y[(k + 1) % 3].cross(y[(k + 2) % 3]) / (2 * rest.area);
  }
  // Of differences: of the corners themselves the last digits of a small face are lost.
  face.areaRatio = determinant(y[0], y[1] - y[0], y[2] - y[0]) / (2 * rest.area);
  return face;
}

TangentFrame tangentFrame(const Vector& unit) {
  // Continuous but at two points [Duff2017].
  const double sign = std::copysign(1.0, unit.z()), a = -1 / (sign + unit.z());
  const double b = unit.x() * unit.y() * a;
  TangentFrame frame;
  frame.col(0) << 1 + sign * unit.x() * unit.x() * a, sign * b, -sign * unit.x();
  frame.col(1) << b, sign + unit.y() * unit.y() * a, -unit.y();
  return frame;
}

SphereEnergy::SphereEnergy(Faces faces, std::vector<RestFace> rest, const MapWeights& weights)
    : faces_(std::move(faces)), rest_(std::move(rest)), share_(rest_.size()), weights_(weights) {
  double total = 0;
  for (const RestFace& face : rest_) total += face.area;
  for (std::size_t f = 0; f < rest_.size(); ++f) share_[f] = weights.whole * rest_[f].area / total;
}

double SphereEnergy::value(const Positions& sphere) const {
  return parallelSum(rest_.size(), kFacesATask, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t f = begin; f < end; ++f) {
      const auto y = cornersOf(sphere, faces_, static_cast<Eigen::Index>(f));
      const auto& g = rest_[f].gradient;
      // The gradients of the three corners sum to 0.
      const Vector u = y[1] - y[0], v = y[2] - y[0];
      const double s = (g[1].real() * u + g[2].real() * v).squaredNorm() +
                       (g[1].imag() * u + g[2].imag() * v).squaredNorm();
      const double d = determinant(y[0], u, v) / (2 * rest_[f].area);
      sum += share_[f] * sphereDensity(s, d, weights_).value;
    }
    return sum;
  });
}

geometry::FaceSystem::Term SphereEnergy::term(const Positions& sphere,
                                              const std::vector<TangentFrame>& frames,
                                              Eigen::Index f) const {
  const auto y = cornersOf(sphere, faces_, f);
  const RestFace& rest = rest_[f];
  const SphereFace face = sphereFace(rest, y);
  const SphereDensity psi = sphereDensity(face.squaredJacobian, face.areaRatio, weights_);
  const double w = share_[f], dDD = convexDD(psi, face.squaredJacobian);
  std::array<Eigen::Vector2d, 3> s, d;
  geometry::FaceSystem::Term term;
  for (int k = 0; k < 3; ++k) {
    const TangentFrame& frame = frames[faces_(f, k)];
    s[k] = frame.transpose() * face.gradientS[k];
    d[k] = frame.transpose() * face.gradientD[k];
    term.gradient.segment<2>(2 * k) = w * (psi.dS * s[k] + psi.dD * d[k]);
  }
  const double stiffness = 2 * psi.dS + std::abs(psi.dD) / 2;
  for (int j = 0; j < 3; ++j) {
    const TangentFrame& frameJ = frames[faces_(f, j)];
    for (int k = 0; k <= j; ++k) {
      const TangentFrame& frameK = frames[faces_(f, k)];
      const double dot = (std::conj(rest.gradient[j]) * rest.gradient[k]).real();
      Eigen::Matrix2d block = stiffness * dot * frameJ.transpose() * frameK;
      block += psi.dSD * (s[j] * d[k].transpose() + d[j] * s[k].transpose());
      block += dDD * d[j] * d[k].transpose();
      if (j != k) {
        // Of y_j . (y_k x y_m) by y_k, or of its negative where (j, k, m) is not in order.
        const Vector& m = y[3 - j - k];
        const double sign = (j + 1) % 3 == k ? -1 : 1;
        block +=
            psi.dD / 2 * sign / (2 * rest.area) * (frameJ.transpose() * crossMatrix(m) * frameK);
      }
      term.hessian.block<2, 2>(2 * j, 2 * k) = w * block;
      term.hessian.block<2, 2>(2 * k, 2 * j) = w * block.transpose();
    }
  }
  return term;
}

double SphereEnergy::largestStep(const Positions& sphere, const Positions& step) const {
  std::vector<double> least((rest_.size() + kFacesATask - 1) / kFacesATask, kInfinity);
  parallelForBlocks(rest_.size(), kFacesATask, [&](std::size_t begin, std::size_t end) {
    double first = kInfinity;
    for (std::size_t f = begin; f < end; ++f) {
      const auto y = cornersOf(sphere, faces_, static_cast<Eigen::Index>(f));
      const auto t = cornersOf(step, faces_, static_cast<Eigen::Index>(f));
      const Vector u = y[1] - y[0], v = y[2] - y[0], du = t[1] - t[0], dv = t[2] - t[0];
      const double b =
          determinant(t[0], u, v) + determinant(y[0], du, v) + determinant(y[0], u, dv);
      const double c =
          determinant(y[0], du, dv) + determinant(t[0], du, v) + determinant(t[0], u, dv);
      first = std::min(first, flattening::firstRoot(determinant(y[0], u, v), b, c));
    }
    least[begin / kFacesATask] = first;
  });
  return std::min(1.0, flattening::kShareOfWay * *std::ranges::min_element(least));
}

std::vector<RestFace> restOnUnitSphere(const flattening::IntrinsicMesh& mesh) {
  constexpr double kLeastHeight = 1e-3;  // of the mean edge length
  flattening::IntrinsicMesh scaled = mesh;
  double area = 0;
  for (const RestFace& face : restFaces(mesh, kLeastHeight * mesh.lengths.mean()))
    area += face.area;
  scaled.lengths *= std::sqrt(4 * kPi / area);
  return restFaces(scaled, kLeastHeight * scaled.lengths.mean());
}

}  // namespace explica::sphere
