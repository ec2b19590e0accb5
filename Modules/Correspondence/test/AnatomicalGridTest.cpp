// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/AnatomicalGrid.h"

#include "Explica/Core/Errors.h"
#include "Explica/Harmonic/Phantoms.h"

#include <Eigen/Geometry>
#include <Eigen/IterativeLinearSolvers>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>

using namespace explica;
using namespace explica::correspondence;
using harmonic::ExactAnnulus;

namespace {

AnatomicalGrid gridOf(const ExactAnnulus& exact, const Grid& grid, int levels) {
  const auto annulus = harmonic::annulusFromLevels(harmonic::sampled(grid, exact.innerLevel),
                                                   harmonic::sampled(grid, exact.outerLevel),
                                                   {0, harmonic::LevelInside::Below});
  return anatomicalGrid(annulus, harmonic::solveInterpolant(annulus), levels);
}

Point pointOf(const AnatomicalGrid& grid, Eigen::Index cell, int corner) {
  return grid.points.row(grid.cells(cell, corner)).transpose();
}

/// VTK's parametric coordinates of a hexahedron's corners.
constexpr std::array<std::array<int, 3>, 8> kCorner = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// Derivatives of the eight trilinear shape functions at parametric coordinates.
Eigen::Matrix<double, 8, 3> shapeSlopes(const Vector& r) {
  Eigen::Matrix<double, 8, 3> slopes;
  for (int c = 0; c < 8; ++c) {
    for (int d = 0; d < 3; ++d) {
      double product = kCorner[c][d] ? 1 : -1;
      for (int e = 0; e < 3; ++e) {
        if (e != d) product *= kCorner[c][e] ? r[e] : 1 - r[e];
      }
      slopes(c, d) = product;
    }
  }
  return slopes;
}

/// Rows: derivatives of the world point by r, s, t.
Eigen::Matrix3d jacobian(const AnatomicalGrid& grid, Eigen::Index cell,
                         const Eigen::Matrix<double, 8, 3>& slopes) {
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  for (int c = 0; c < 8; ++c) {
    result += slopes.row(c).transpose() * pointOf(grid, cell, c).transpose();
  }
  return result;
}

/// Sum over the cells by two Gauss points along each axis, exact for the volume of a trilinear
/// cell.
template <class Function>
void integrate(const AnatomicalGrid& grid, const Function& at) {
  const double near = 0.5 - std::sqrt(1.0 / 12), far = 1 - near;
  for (Eigen::Index cell = 0; cell < grid.cells.rows(); ++cell) {
    for (int q = 0; q < 8; ++q) {
      const Vector r(q & 1 ? far : near, q & 2 ? far : near, q & 4 ? far : near);
      const auto slopes = shapeSlopes(r);
      at(cell, slopes, jacobian(grid, cell, slopes));
    }
  }
}

double volumeOf(const AnatomicalGrid& grid) {
  double sum = 0;
  integrate(grid, [&](Eigen::Index, const auto&, const Eigen::Matrix3d& j) {
    sum += j.determinant() / 8;
  });
  return sum;
}

double areaOf(const AnatomicalGrid& grid) {
  double sum = 0;
  for (Eigen::Index c = 0; c < grid.cells.rows(); ++c) {
    const Vector a = pointOf(grid, c, 2) - pointOf(grid, c, 0);
    const Vector b = pointOf(grid, c, 3) - pointOf(grid, c, 1);
    sum += 0.5 * a.cross(b).dot(grid.normal);
  }
  return sum;
}

double lowestJacobian(const AnatomicalGrid& grid) {
  double lowest = kInfinity;
  for (Eigen::Index cell = 0; cell < grid.cells.rows(); ++cell) {
    for (const auto& corner : kCorner) {
      const Vector r(corner[0], corner[1], corner[2]);
      lowest = std::min(lowest, jacobian(grid, cell, shapeSlopes(r)).determinant());
    }
  }
  return lowest;
}

/// Turned, mirrored and moved, so that a tissue about the origin stays in the field of view.
Grid placed(Grid grid, const Eigen::Matrix3d& direction) {
  grid.origin = direction * grid.origin;
  grid.direction = direction;
  return grid;
}

std::vector<Eigen::Matrix3d> directions() {
  std::vector<Eigen::Matrix3d> all = {Eigen::Matrix3d::Identity(),
                                      Vector(-1, 1, 1).asDiagonal().toDenseMatrix(),
                                      Vector(-1, -1, -1).asDiagonal().toDenseMatrix()};
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 4; ++n) {
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    Eigen::Matrix3d turned = q.normalized().toRotationMatrix();
    if (n % 2) turned.col(n % 3) *= -1;
    all.push_back(turned);
  }
  return all;
}

constexpr double kShellVolume = 4 * kPi / 3 * (13.0 * 13 * 13 - 7.0 * 7 * 7);

}  // namespace

TEST(AnatomicalGrid, FollowsTheExactTrajectories) {
  const ExactAnnulus circles = harmonic::exactEccentric(10, 25, 5);
  const ExactAnnulus spheroids = harmonic::exactSpheroids(30, 0.5, 1);
  const std::array<std::pair<ExactAnnulus, Grid>, 2> cases = {
      std::pair{circles, harmonic::centredGrid({72, 72, 1}, {0.75, 0.75, 1})},
      std::pair{spheroids, harmonic::centredGrid({64, 64, 88}, Vector::Constant(1))}};
  for (const auto& [exact, lattice] : cases) {
    const AnatomicalGrid grid = gridOf(exact, lattice, 4);
    EXPECT_EQ(grid.lost, 0U);
    EXPECT_EQ(grid.degenerate, 0U);
    EXPECT_EQ(grid.cells.cols(), exact.dimension == 2 ? 4 : 8);
    for (Eigen::Index p = 0; p < grid.points.rows(); p += 5) {
      const auto answer = exact.answer(grid.points.row(p + 2).transpose());
      EXPECT_NEAR(answer.innerDistance / answer.thickness(), 0.5, 0.01);
      EXPECT_NEAR((grid.points.row(p).transpose() - answer.innerPoint).norm(), 0, 0.1);
      EXPECT_NEAR((grid.points.row(p + 4).transpose() - answer.outerPoint).norm(), 0, 0.1);
    }
  }
}

TEST(AnatomicalGrid, EveryCornerOfEveryHexahedronIsRightHandedWhateverTheAffine) {
  for (const Vector& spacing : {Vector(1, 1, 1), Vector(0.6, 0.9, 1.3), Vector(0.5, 0.5, 2)}) {
    const Vector voxels = Vector::Constant(30).cwiseQuotient(spacing).array().ceil();
    const Grid lattice =
        harmonic::centredGrid({int(voxels[0]), int(voxels[1]), int(voxels[2])}, spacing);
    for (const Eigen::Matrix3d& direction : directions()) {
      const auto grid = gridOf(harmonic::exactShell(7, 13), placed(lattice, direction), 3);
      EXPECT_GT(grid.cells.rows(), 500);
      EXPECT_GT(lowestJacobian(grid), 0);
      EXPECT_EQ(grid.lost, 0U);
      EXPECT_LE(static_cast<double>(grid.degenerate), 0.002 * grid.cells.rows());
      EXPECT_NEAR(volumeOf(grid), kShellVolume, 0.01 * kShellVolume);
    }
  }
}

TEST(AnatomicalGrid, QuadrilateralsOfASliceWindOneWay) {
  for (const Eigen::Matrix3d& direction : directions()) {
    const Grid lattice = placed(harmonic::centredGrid({72, 60, 1}, {0.75, 0.9, 1}), direction);
    const ExactAnnulus circles = harmonic::exactShell(10, 25, 2);
    ExactAnnulus inPlane = circles;
    const auto flat = [&](const Point& x) -> Point { return direction.transpose() * x; };
    inPlane.innerLevel = [&](const Point& x) { return circles.innerLevel(flat(x)); };
    inPlane.outerLevel = [&](const Point& x) { return circles.outerLevel(flat(x)); };
    const auto grid = gridOf(inPlane, lattice, 3);
    Eigen::Index greatest = 0;
    EXPECT_NEAR(grid.normal.norm(), 1, 1e-12);
    grid.normal.cwiseAbs().maxCoeff(&greatest);
    EXPECT_GT(grid.normal[greatest], 0);
    for (Eigen::Index c = 0; c < grid.cells.rows(); ++c) {
      for (int k = 0; k < 4; ++k) {
        const Vector a = pointOf(grid, c, (k + 1) % 4) - pointOf(grid, c, k);
        const Vector b = pointOf(grid, c, (k + 3) % 4) - pointOf(grid, c, k);
        EXPECT_GT(a.cross(b).dot(grid.normal), 0);
      }
    }
    const double ring = kPi * (25 * 25 - 10 * 10);
    EXPECT_NEAR(areaOf(grid), ring, 0.01 * ring);
  }
}

TEST(AnatomicalGrid, NeighbouringCellsShareWholeFaces) {
  const auto grid = gridOf(harmonic::exactSpheroids(30, 0.5, 1),
                           harmonic::centredGrid({64, 64, 88}, Vector::Constant(1)), 2);
  constexpr int kSides[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::map<std::array<std::int32_t, 4>, int> cellsAt;
  for (Eigen::Index c = 0; c < grid.cells.rows(); ++c) {
    for (const auto& side : kSides) {
      std::array<std::int32_t, 4> face = {};
      for (int k = 0; k < 4; ++k) face[k] = grid.cells(c, side[k]);
      std::sort(face.begin(), face.end());
      ++cellsAt[face];
    }
  }
  for (const auto& [face, cells] : cellsAt) {
    const bool rim = std::all_of(face.begin(), face.end(), [&](std::int32_t p) {
      return grid.depth[p] == grid.depth[face[0]] && (grid.depth[p] == 0 || grid.depth[p] == 1);
    });
    ASSERT_EQ(cells, rim ? 1 : 2);
  }
}

TEST(AnatomicalGrid, OpenEndsKeepTheirHalfVoxel) {
  // A tube of nine slices, closed by insulation: the grid reaches to the faces of the end slices.
  const Grid lattice = harmonic::centredGrid({64, 64, 9}, {0.5, 0.5, 1.5});
  const auto radius = [](const Point& x) { return std::hypot(x[0], x[1]); };
  const auto annulus = harmonic::annulusFromLevels(
      harmonic::sampled(lattice, [&](const Point& x) { return radius(x) - 8; }),
      harmonic::sampled(lattice, [&](const Point& x) { return radius(x) - 13; }),
      {0, harmonic::LevelInside::Below}, {.openEnds = true});
  const auto grid = anatomicalGrid(annulus, harmonic::solveInterpolant(annulus), 3);
  const double volume = kPi * (13 * 13 - 8 * 8) * 9 * 1.5;
  EXPECT_NEAR(volumeOf(grid), volume, 0.01 * volume);
}

TEST(AnatomicalGrid, FiniteElementsOnItGiveTheHarmonicFunction) {
  // Trilinear elements, u = 0 and 1 on the inner and the outer layer of points.
  const ExactAnnulus exact = harmonic::exactSpheroids(30, 0.5, 1);
  std::array<double, 2> errors = {};
  for (int fine = 0; fine < 2; ++fine) {
    const double h = fine ? 1.5 : 3;
    const int across = fine ? 44 : 22, along = fine ? 60 : 30;
    const auto grid = gridOf(
        exact, harmonic::centredGrid({across, across, along}, Vector::Constant(h)), fine ? 6 : 3);
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd load = Eigen::VectorXd::Zero(grid.points.rows());
    const auto fixed = [&](std::int32_t p) { return grid.depth[p] == 0 || grid.depth[p] == 1; };
    integrate(grid, [&](Eigen::Index cell, const auto& slopes, const Eigen::Matrix3d& j) {
      const Eigen::Matrix<double, 3, 8> g = j.inverse() * slopes.transpose();
      const Eigen::Matrix<double, 8, 8> k = g.transpose() * g * (j.determinant() / 8);
      for (int a = 0; a < 8; ++a) {
        const std::int32_t p = grid.cells(cell, a);
        if (fixed(p)) continue;
        for (int b = 0; b < 8; ++b) {
          const std::int32_t q = grid.cells(cell, b);
          if (fixed(q)) {
            load[p] -= k(a, b) * grid.depth[q];
          } else {
            entries.emplace_back(p, q, k(a, b));
          }
        }
      }
    });
    for (std::int32_t p = 0; p < grid.points.rows(); ++p) {
      if (!fixed(p)) continue;
      entries.emplace_back(p, p, 1);
      load[p] = grid.depth[p];
    }
    Eigen::SparseMatrix<double> stiffness(grid.points.rows(), grid.points.rows());
    stiffness.setFromTriplets(entries.begin(), entries.end());
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver(
        stiffness);
    solver.setTolerance(1e-5);
    const Eigen::VectorXd u = solver.solve(load);
    ASSERT_EQ(solver.info(), Eigen::Success);
    for (Eigen::Index p = 0; p < grid.points.rows(); ++p) {
      errors[fine] =
          std::max(errors[fine], std::abs(u[p] - exact.answer(grid.points.row(p).transpose()).u));
    }
    std::printf("finite elements at %g mm: greatest error of u %.4f\n", h, errors[fine]);
  }
  EXPECT_LE(errors[1], 0.01);
  EXPECT_LE(errors[1], 0.5 * errors[0]);
}
