// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/HarmonicAnnulus.h"

#include "AngularBasis.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::shapes {
namespace {

// Of a great circle: between them a range grows by half a percent (one percent in space).
constexpr int kSamplesPerOrder = 32;

constexpr int kHighestOrderInPlane = 512;  // 1025 coefficients a boundary
constexpr int kHighestOrderInSpace = 64;   // 4225 coefficients a boundary

int samplesOf(const HarmonicAnnulus& annulus, int perOrder) {
  return perOrder * std::max(annulus.order, 1);
}

/// How much the half range of a boundary's values may exceed that of its samples.
double rangeGrowth(const HarmonicAnnulus& annulus) {
  const double once = 1 / std::cos(kPi / kSamplesPerOrder);
  return annulus.dimension == 2 ? once : once * once;
}

/// From the centre to a point.
Vector fromCentre(const HarmonicAnnulus& annulus, const Point& point) {
  Vector d = point - annulus.centre;
  if (annulus.dimension == 2) d.z() = 0;
  return d;
}

/// One row of the basis.
void basisRow(const HarmonicAnnulus& annulus, const Point& point, Eigen::VectorXd& angular,
              Eigen::Ref<Eigen::VectorXd> row) {
  const int n = annulus.perBoundary();
  const Vector d = fromCentre(annulus, point);
  const double length = d.norm();
  const double r = std::clamp(length, annulus.innerRadius, annulus.outerRadius);
  angularBasis(annulus.dimension, annulus.order, length > 0 ? Vector(d / length) : Vector::UnitX(),
               angular.data());
  int degree = -1;
  RadialFactors radial;
  for (int k = 0; k < n; ++k) {
    const int l = degreeOf(annulus.dimension, k);
    if (l != degree) {
      degree = l;
      radial = radialFactors(annulus.dimension, l, r, annulus.innerRadius, annulus.outerRadius);
    }
    row[k] = angular[k] * radial.inner;
    row[n + k] = angular[k] * radial.outer;
  }
}

}  // namespace

void requireUsable(const HarmonicAnnulus& annulus) {
  if (annulus.dimension != 2 && annulus.dimension != 3) {
    throw InvalidInput("annulus: dimension " + std::to_string(annulus.dimension) +
                       " found, 2 or 3 needed");
  }
  if (!(annulus.innerRadius > 0 && annulus.outerRadius > annulus.innerRadius)) {
    throw InvalidInput("annulus: radii " + std::to_string(annulus.innerRadius) + " and " +
                       std::to_string(annulus.outerRadius) + " found, 0 < inner < outer needed");
  }
  const int highest = annulus.dimension == 2 ? kHighestOrderInPlane : kHighestOrderInSpace;
  if (annulus.order < 0 || annulus.order > highest) {
    throw InvalidInput("annulus: order " + std::to_string(annulus.order) + " found, 0 to " +
                       std::to_string(highest) + " allowed");
  }
}

bool sameAnnulus(const HarmonicAnnulus& a, const HarmonicAnnulus& b) {
  if (a.dimension != b.dimension || a.order != b.order) return false;
  return a.innerRadius == b.innerRadius && a.outerRadius == b.outerRadius && a.centre == b.centre;
}

AnnulusSide sideOf(const HarmonicAnnulus& annulus, const Point& point) {
  const double r = fromCentre(annulus, point).norm();
  if (r <= annulus.innerRadius) return AnnulusSide::Enclosed;
  return r < annulus.outerRadius ? AnnulusSide::Inside : AnnulusSide::Beyond;
}

double widthOf(const HarmonicAnnulus& annulus) {
  return annulus.outerRadius - annulus.innerRadius;
}

Eigen::MatrixXd basisAt(const HarmonicAnnulus& annulus, const Positions& points) {
  const int n = annulus.perBoundary();
  Eigen::MatrixXd byColumn(2 * n, points.rows());
  parallelForBlocks(
      static_cast<std::size_t>(points.rows()), 256, [&](std::size_t a, std::size_t b) {
        Eigen::VectorXd angular(n);
        for (std::size_t p = a; p < b; ++p) {
          const auto column = static_cast<Eigen::Index>(p);
          basisRow(annulus, points.row(column).transpose(), angular, byColumn.col(column));
        }
      });
  return byColumn.transpose();
}

Eigen::VectorXd valuesAt(const HarmonicShape& shape, const Positions& points) {
  const int n = shape.annulus.perBoundary();
  Eigen::VectorXd coefficients(2 * n);
  coefficients << shape.inner, shape.outer;
  Eigen::VectorXd values(points.rows());
  parallelForBlocks(static_cast<std::size_t>(points.rows()), 256,
                    [&](std::size_t a, std::size_t b) {
                      Eigen::VectorXd angular(n);
                      Eigen::VectorXd row(2 * n);
                      for (std::size_t p = a; p < b; ++p) {
                        const auto at = static_cast<Eigen::Index>(p);
                        basisRow(shape.annulus, points.row(at).transpose(), angular, row);
                        values[at] = row.dot(coefficients);
                      }
                    });
  return values;
}

SampleRows boundarySamples(const HarmonicAnnulus& annulus, int perOrder) {
  const int samples = samplesOf(annulus, perOrder);
  const int n = annulus.perBoundary();
  const int rings = annulus.dimension == 2 ? 1 : samples / 2;
  SampleRows rows(static_cast<Eigen::Index>(samples) * rings, n);
  parallelFor(static_cast<std::size_t>(samples), 8, [&](std::size_t k) {
    const double phi = 2 * kPi * static_cast<double>(k) / samples;
    for (int j = 0; j < rings; ++j) {
      // Meridian circles have equally spaced samples on both their halves.
      const double theta = annulus.dimension == 2 ? kPi / 2 : 2 * kPi * (j + 0.5) / samples;
      const Vector direction(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                             std::cos(theta));
      angularBasis(annulus.dimension, annulus.order, direction,
                   rows.row(static_cast<Eigen::Index>(k) * rings + j).data());
    }
  });
  return rows;
}

double boundaryMargin(const HarmonicShape& shape) {
  const SampleRows samples = boundarySamples(shape.annulus, kSamplesPerOrder);
  const double growth = rangeGrowth(shape.annulus);
  const auto leastOf = [&](const Eigen::VectorXd& v) {
    const double middle = (v.minCoeff() + v.maxCoeff()) / 2;
    return middle - growth * (v.maxCoeff() - v.minCoeff()) / 2;
  };
  const Eigen::VectorXd below = (0.5 - (samples * shape.inner).array()).matrix();
  const Eigen::VectorXd above = ((samples * shape.outer).array() - 0.5).matrix();
  return std::min(leastOf(below), leastOf(above));
}

}  // namespace explica::shapes
