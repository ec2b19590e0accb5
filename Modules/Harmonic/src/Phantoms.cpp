// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/Phantoms.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::harmonic {

namespace {

/// Integral of a smooth function by 16 panels of five-point Gauss-Legendre quadrature.
template <class Function>
double integral(double from, double to, const Function& f) {
  constexpr std::array<double, 3> node = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 3> weight = {0.5688888888888889, 0.4786286704993665,
                                            0.2369268850561891};
  constexpr int kPanels = 16;
  const double half = 0.5 * (to - from) / kPanels;
  double sum = 0;
  for (int p = 0; p < kPanels; ++p) {
    const double middle = from + (2 * p + 1) * half;
    sum += weight[0] * f(middle);
    for (int k = 1; k < 3; ++k) {
      sum += weight[k] * (f(middle - half * node[k]) + f(middle + half * node[k]));
    }
  }
  return sum * half;
}

/// Prolate spheroidal coordinates of a point: foci at +-focal on the third axis.
struct Prolate {
  double xi = 1, eta = 0, cosPhi = 1, sinPhi = 0;
  Prolate(double focal, const Point& x) {
    const double rho = std::hypot(x[0], x[1]);
    const double plus = std::hypot(rho, x[2] + focal), minus = std::hypot(rho, x[2] - focal);
    xi = std::max(1.0, (plus + minus) / (2 * focal));
    eta = std::clamp((plus - minus) / (2 * focal), -1.0, 1.0);
    if (rho > 0) {
      cosPhi = x[0] / rho;
      sinPhi = x[1] / rho;
    }
  }
  [[nodiscard]] Point at(double focal, double otherXi) const {
    const double rho = focal * std::sqrt(std::max(0.0, (otherXi * otherXi - 1) * (1 - eta * eta)));
    return {rho * cosPhi, rho * sinPhi, focal * otherXi * eta};
  }
};

}  // namespace

ExactAnnulus exactShell(double a, double b, int dimension) {
  const auto radius = [dimension](const Point& x) {
    return dimension == 2 ? std::hypot(x[0], x[1]) : x.norm();
  };
  ExactAnnulus exact;
  exact.dimension = dimension;
  exact.innerLevel = [=](const Point& x) { return radius(x) - a; };
  exact.outerLevel = [=](const Point& x) { return radius(x) - b; };
  exact.answer = [=](const Point& x) {
    const double r = radius(x);
    Point from = x;
    if (dimension == 2) from[2] = 0;
    ExactAnswer answer;
    answer.u =
        dimension == 2 ? std::log(r / a) / std::log(b / a) : (1 / a - 1 / r) / (1 / a - 1 / b);
    answer.innerDistance = r - a;
    answer.outerDistance = b - r;
    answer.innerPoint = a / r * from;
    answer.outerPoint = b / r * from;
    if (dimension == 2) answer.innerPoint[2] = answer.outerPoint[2] = x[2];
    return answer;
  };
  return exact;
}

ExactAnnulus exactEccentric(double r0, double r1, double offset) {
  // Circles tau = const have centres a coth tau and radii a / sinh tau on the first axis.
  const double d1 = 0.5 * ((r1 * r1 - r0 * r0) / offset + offset);
  const double a = std::sqrt(d1 * d1 - r1 * r1);
  const double tau0 = std::asinh(a / r0), tau1 = std::asinh(a / r1);
  ExactAnnulus exact;
  exact.dimension = 2;
  exact.innerLevel = [=](const Point& x) { return std::hypot(x[0] + offset, x[1]) - r0; };
  exact.outerLevel = [=](const Point& x) { return std::hypot(x[0], x[1]) - r1; };
  exact.answer = [=](const Point& p) {
    const double x = p[0] + d1, y = p[1];
    const double tau = std::atanh(2 * a * x / (x * x + y * y + a * a));
    const double sigma = std::atan2(2 * a * y, x * x + y * y - a * a);
    const auto at = [&](double t) {
      const double scale = a / (std::cosh(t) - std::cos(sigma));
      return Point(scale * std::sinh(t) - d1, scale * std::sin(sigma), p[2]);
    };
    const auto speed = [&](double t) { return a / (std::cosh(t) - std::cos(sigma)); };
    return ExactAnswer{.u = (tau0 - tau) / (tau0 - tau1),
                       .innerDistance = integral(tau, tau0, speed),
                       .outerDistance = integral(tau1, tau, speed),
                       .innerPoint = at(tau0),
                       .outerPoint = at(tau1)};
  };
  return exact;
}

ExactAnnulus exactSpheroids(double focal, double innerSinh, double outerSinh) {
  const double xi0 = std::sqrt(1 + innerSinh * innerSinh);
  const double xi1 = std::sqrt(1 + outerSinh * outerSinh);
  const auto potential = [](double xi) { return std::log((xi - 1) / (xi + 1)); };
  // (xi - xi_b) / |grad xi| is the distance near the boundary.
  const auto level = [focal](const Point& x, double boundary) {
    const Prolate q(focal, x);
    const double floor = 1e-6;  // on the segment between the foci xi has no gradient
    return (q.xi - boundary) * focal *
           std::sqrt((q.xi * q.xi - q.eta * q.eta + floor) / (q.xi * q.xi - 1 + floor));
  };
  ExactAnnulus exact;
  exact.innerLevel = [=](const Point& x) { return level(x, xi0); };
  exact.outerLevel = [=](const Point& x) { return level(x, xi1); };
  exact.answer = [=](const Point& x) {
    const Prolate q(focal, x);
    const auto speed = [&](double xi) {
      return focal * std::sqrt((xi * xi - q.eta * q.eta) / (xi * xi - 1));
    };
    return ExactAnswer{.u = (potential(q.xi) - potential(xi0)) / (potential(xi1) - potential(xi0)),
                       .innerDistance = integral(xi0, q.xi, speed),
                       .outerDistance = integral(q.xi, xi1, speed),
                       .innerPoint = q.at(focal, xi0),
                       .outerPoint = q.at(focal, xi1)};
  };
  return exact;
}

ExactAnnulus exactVentricle(double focal, double innerSinh, double outerSinh, double base) {
  ExactAnnulus exact = exactSpheroids(focal, innerSinh, outerSinh);
  exact.insulated = [base](const Point& x) { return x[2] > base; };
  return exact;
}

Grid centredGrid(const std::array<int, 3>& size, const Vector& spacing) {
  Grid grid;
  grid.size = size;
  grid.spacing = spacing;
  for (int a = 0; a < 3; ++a) grid.origin[a] = -0.5 * (size[a] - 1) * spacing[a];
  return grid;
}

Volume<float> sampled(const Grid& grid, const std::function<double(const Point&)>& function) {
  Volume<float> volume(grid);
  parallelFor(static_cast<std::size_t>(grid.size[1]) * grid.size[2], 16, [&](std::size_t row) {
    const int j = static_cast<int>(row % grid.size[1]), k = static_cast<int>(row / grid.size[1]);
    for (int i = 0; i < grid.size[0]; ++i) {
      volume(i, j, k) = static_cast<float>(function(grid.toWorld(Vector(i, j, k))));
    }
  });
  return volume;
}

Phantom makePhantom(PhantomKind kind, const PhantomOptions& options) {
  if (options.size < 8 || !(options.spacing > 0)) {
    throw InvalidInput("a phantom needs at least 8 voxels along each axis and a positive spacing");
  }
  Phantom phantom;
  double reach = 0;  // mm from the centre to the phantom's end
  std::array<int, 3> size = {options.size, options.size, options.size};
  constexpr double kVentricleFocal = 40, kVentricleInner = 0.6, kVentricleOuter = 0.9;
  switch (kind) {
    case PhantomKind::Shell:
      phantom.exact = exactShell(20, 30);
      reach = 30;
      break;
    case PhantomKind::Eccentric:
      phantom.exact = exactEccentric(10, 25, 5);
      reach = 25;
      size[2] = 1;
      break;
    case PhantomKind::Spheroid:
      phantom.exact = exactSpheroids(30, 0.5, 1);
      reach = 30 * std::sqrt(2.0);
      break;
    case PhantomKind::Ventricle:
      phantom.exact = exactVentricle(kVentricleFocal, kVentricleInner, kVentricleOuter, 15);
      reach = kVentricleFocal * std::sqrt(1 + kVentricleOuter * kVentricleOuter);
      break;
  }
  if (0.5 * options.size * options.spacing < reach + options.spacing) {
    throw InvalidInput("this phantom reaches " + std::to_string(reach) +
                       " mm from the centre; size times spacing must exceed twice that");
  }
  const Grid grid = centredGrid(size, Vector::Constant(options.spacing));
  phantom.innerLevel = sampled(grid, phantom.exact.innerLevel);
  phantom.outerLevel = sampled(grid, phantom.exact.outerLevel);
  phantom.labels = Volume<Label>(grid, 0);
  phantom.labelNames = {{"outer", 0}, {"inner", 1}, {"tissue", 2}};
  if (kind == PhantomKind::Ventricle) {
    phantom.labelNames.emplace_back("right-ventricle", 3);
    phantom.labelNames.emplace_back("insulated", 4);
  }
  const double equator = kVentricleFocal * kVentricleOuter;
  parallelFor(grid.voxelCount(), 1 << 14, [&](std::size_t v) {
    const auto s = grid.subscripts(v);
    const Point x = grid.toWorld(Vector(s[0], s[1], s[2]));
    if (phantom.exact.insulated && phantom.exact.insulated(x)) {
      phantom.labels[v] = 4;
    } else if (phantom.innerLevel[v] <= 0) {
      phantom.labels[v] = 1;
    } else if (phantom.outerLevel[v] < 0) {
      phantom.labels[v] = 2;
    } else if (kind == PhantomKind::Ventricle && x[2] > -0.6 * reach &&
               std::hypot(x[0] + 0.6 * equator, x[1]) < 0.8 * equator) {
      phantom.labels[v] = 3;  // a crescent beside the wall, at negative x
    }
  });
  return phantom;
}

PhantomAnswers answersOf(const Phantom& phantom) {
  const Grid& grid = phantom.labels.grid;
  PhantomAnswers answers;
  answers.u = answers.thickness = answers.innerDistance = answers.outerDistance =
      Volume<float>(grid, 0);
  answers.innerPoint = answers.outerPoint = Volume<Eigen::Vector3f>(grid, Eigen::Vector3f::Zero());
  parallelFor(grid.voxelCount(), 1 << 12, [&](std::size_t v) {
    if (phantom.labels[v] != 2) {
      answers.u[v] = phantom.innerLevel[v] <= 0 ? 0.0F : 1.0F;
      return;
    }
    const auto s = grid.subscripts(v);
    const ExactAnswer exact = phantom.exact.answer(grid.toWorld(Vector(s[0], s[1], s[2])));
    answers.u[v] = static_cast<float>(exact.u);
    answers.thickness[v] = static_cast<float>(exact.thickness());
    answers.innerDistance[v] = static_cast<float>(exact.innerDistance);
    answers.outerDistance[v] = static_cast<float>(exact.outerDistance);
    answers.innerPoint[v] = exact.innerPoint.cast<float>();
    answers.outerPoint[v] = exact.outerPoint.cast<float>();
  });
  return answers;
}

}  // namespace explica::harmonic
