// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/MapEnergy.h"

#include "Explica/Core/Parallel.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace explica::flattening {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kGrain = 1024;  // faces a task: some 50 microseconds of work

/// The two numbers of the linear map z -> p z + q conj(z) of a face.
struct LinearMap {
  Complex p, q;
};

LinearMap mapOf(const RestFace& rest, const Faces& faces, const FlatPositions& flat,
                Eigen::Index f) {
  LinearMap map{0, 0};
  for (int k = 0; k < 3; ++k) {
    const std::int32_t v = faces(f, k);
    const Complex z(flat(v, 0), flat(v, 1));
    map.p += z * std::conj(rest.gradient[k]) / 2.0;
    map.q += z * rest.gradient[k] / 2.0;
  }
  return map;
}

/// Row of the derivative of Re(conj(direction) w), w = sum of z_k weight_k, for corners x0 y0 ...
Eigen::Matrix<double, 6, 1> rowOf(const std::array<Complex, 3>& weights, Complex direction) {
  Eigen::Matrix<double, 6, 1> row;
  for (int k = 0; k < 3; ++k) {
    const Complex w = weights[k] * std::conj(direction);
    row[2 * k] = w.real();
    row[2 * k + 1] = -w.imag();
  }
  return row;
}

Complex unit(Complex z, double size) {
  return size > 0 ? z / size : Complex(1, 0);
}

}  // namespace

IntrinsicMesh intrinsicOf(const TriangleMesh& mesh) {
  IntrinsicMesh intrinsic{mesh.faces, Positions(mesh.faceCount(), 3), mesh.vertexCount()};
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      intrinsic.lengths(f, k) = (mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k)).norm();
    }
  }
  return intrinsic;
}

std::vector<RestFace> restFaces(const IntrinsicMesh& mesh, double smallestHeight,
                                std::size_t* raised) {
  std::vector<RestFace> rest(static_cast<std::size_t>(mesh.faces.rows()));
  std::size_t count = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    bool low = false;
    rest[f] = restFace({mesh.lengths(f, 0), mesh.lengths(f, 1), mesh.lengths(f, 2)}, smallestHeight,
                       &low);
    count += low;
  }
  if (raised) *raised = count;
  return rest;
}

Density mapDensity(double p, double q, double areaWeight) {
  constexpr double kBarrier = 4;   // keeps faces from vanishing, and areas to some per cent
  constexpr double kKept = 0.006;  // relative area error that counts as none
  const double d = p * p - q * q;
  if (!(d > 0) || !(p > 0)) return {kInfinity};
  const double c = d - 1, root = std::sqrt(kKept * kKept + c * c);
  const double slope = kBarrier * (1 - 1 / (d * d)) / 2 + areaWeight * c / root;
  const double bend = kBarrier / (d * d * d) + areaWeight * kKept * kKept / (root * root * root);
  Density density;
  density.value = 2 * (p - 1) * (p - 1) + 2 * q * q + kBarrier * (d + 1 / d - 2) / 2 +
                  areaWeight * (root - kKept);
  density.dP = 4 * (p - 1) + 2 * p * slope;
  density.dQOverQ = 4 - 2 * slope;
  density.dPP = 4 + 2 * slope + 4 * p * p * bend;
  density.dPQ = -4 * p * q * bend;
  density.dQQ = 4 - 2 * slope + 4 * q * q * bend;
  return density;
}

double firstRoot(double a, double b, double c) {
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return kInfinity;
  const double w = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
  double first = kInfinity;
  for (const double t : {c != 0 ? w / c : kInfinity, w != 0 ? a / w : kInfinity}) {
    if (t > 0 && t < first) first = t;
  }
  return first;
}

MapEnergy::MapEnergy(const IntrinsicMesh& mesh, double areaWeight, double smallestHeight,
                     std::vector<double> faceWeights)
    : faces_(mesh.faces),
      rest_(restFaces(mesh, smallestHeight)),
      weight_(rest_.size()),
      areaWeight_(areaWeight) {
  double total = 0;
  for (const RestFace& face : rest_) total += face.area;
  for (std::size_t f = 0; f < rest_.size(); ++f) {
    weight_[f] = rest_[f].area / total * (faceWeights.empty() ? 1.0 : faceWeights[f]);
  }
}

double MapEnergy::value(const FlatPositions& flat) const {
  return parallelSum(rest_.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t f = begin; f < end; ++f) {
      const LinearMap map = mapOf(rest_[f], faces_, flat, static_cast<Eigen::Index>(f));
      sum += weight_[f] * mapDensity(std::abs(map.p), std::abs(map.q), areaWeight_).value;
    }
    return sum;
  });
}

MapEnergy::FaceTerm MapEnergy::faceTerm(const FlatPositions& flat, Eigen::Index face,
                                        bool convex) const {
  const RestFace& rest = rest_[face];
  const LinearMap map = mapOf(rest, faces_, flat, face);
  const double sizeP = std::abs(map.p), sizeQ = std::abs(map.q);
  const Density d = mapDensity(sizeP, sizeQ, areaWeight_);
  std::array<Complex, 3> ofP, ofQ;
  for (int k = 0; k < 3; ++k) {
    ofP[k] = std::conj(rest.gradient[k]) / 2.0;
    ofQ[k] = rest.gradient[k] / 2.0;
  }
  const Complex alongP = unit(map.p, sizeP), alongQ = unit(map.q, sizeQ);
  const auto radialP = rowOf(ofP, alongP), radialQ = rowOf(ofQ, alongQ);
  const auto turnP = rowOf(ofP, Complex(0, 1) * alongP), turnQ = rowOf(ofQ, Complex(0, 1) * alongQ);
  const double w = weight_[face];

  FaceTerm term;
  term.gradient = w * (d.dP * radialP + d.dQOverQ * sizeQ * radialQ);
  double ofTurnP = d.dP / sizeP, ofTurnQ = d.dQOverQ;
  Eigen::Matrix2d radial;
  radial << d.dPP, d.dPQ, d.dPQ, d.dQQ;
  if (convex) {
    ofTurnP = std::max(0.0, ofTurnP);
    ofTurnQ = std::max(0.0, ofTurnQ);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(radial);
    radial = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
             eigen.eigenvectors().transpose();
  }
  term.hessian =
      w *
      (radial(0, 0) * radialP * radialP.transpose() + radial(1, 1) * radialQ * radialQ.transpose() +
       radial(0, 1) * (radialP * radialQ.transpose() + radialQ * radialP.transpose()) +
       ofTurnP * turnP * turnP.transpose() + ofTurnQ * turnQ * turnQ.transpose());
  return term;
}

FlatPositions MapEnergy::gradient(const FlatPositions& flat) const {
  FlatPositions gradient = FlatPositions::Zero(flat.rows(), 2);
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    const FaceTerm term = faceTerm(flat, f, false);
    for (int k = 0; k < 3; ++k) {
      gradient.row(faces_(f, k)) += term.gradient.segment<2>(2 * k).transpose();
    }
  }
  return gradient;
}

double MapEnergy::largestStep(const FlatPositions& flat, const FlatPositions& step) const {
  std::vector<double> least((rest_.size() + kGrain - 1) / kGrain, kInfinity);
  parallelForBlocks(rest_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    double first = kInfinity;
    for (std::size_t f = begin; f < end; ++f) {
      const Eigen::RowVector2d u = flat.row(faces_(f, 1)) - flat.row(faces_(f, 0));
      const Eigen::RowVector2d v = flat.row(faces_(f, 2)) - flat.row(faces_(f, 0));
      const Eigen::RowVector2d du = step.row(faces_(f, 1)) - step.row(faces_(f, 0));
      const Eigen::RowVector2d dv = step.row(faces_(f, 2)) - step.row(faces_(f, 0));
      const auto cross = [](const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) {
        return a[0] * b[1] - a[1] * b[0];
      };
      first = std::min(first, firstRoot(cross(u, v), cross(u, dv) + cross(du, v), cross(du, dv)));
    }
    least[begin / kGrain] = first;
  });
  return std::min(1.0, kShareOfWay * *std::ranges::min_element(least));
}

}  // namespace explica::flattening
