// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Phantom/Shell.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::phantom {
namespace {

double volumeOf(const Shell& shell) {
  double count = 0;
  for (const Label label : shell.labels.data) count += label == 2;
  return count * shell.labels.grid.voxelVolume();
}

TEST(ShellPhantom, HasTheVolumeOfItsSpheres) {
  for (const Eigen::Vector3d& aspect : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 0.7, 2)}) {
    ShellOptions options;
    options.spacing = 0.5;
    options.aspect = aspect;
    const Shell shell = makeShell(options);
    const double a = shell.innerRadius, b = shell.outerRadius;
    EXPECT_NEAR(a, 8.0, 1e-12);
    EXPECT_NEAR(b, 12.8, 1e-12);
    // A sphere's voxel count scatters by far less than a layer of one hundredth voxel.
    EXPECT_NEAR(volumeOf(shell) / (4.0 / 3 * kPi * (b * b * b - a * a * a)), 1.0, 5e-3);
  }
}

TEST(ShellPhantom, HarmonicMeetsItsBoundaries) {
  const Shell shell = makeShell();
  const harmonic::PhantomAnswers answers = harmonic::answersOf(shell);
  const Grid& grid = shell.labels.grid;
  for (std::size_t v = 0; v < shell.labels.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const double r = grid.toWorld({double(i), double(j), double(k)}).norm();
    if (shell.labels[v] == 2) {
      ASSERT_GE(answers.u[v], 0.f);
      ASSERT_LE(answers.u[v], 1.f);
      // From one boundary point to the other through the voxel is the whole thickness.
      const Point x = grid.toWorld({double(i), double(j), double(k)});
      const Point inner = answers.innerPoint[v].cast<double>();
      const Point outer = answers.outerPoint[v].cast<double>();
      ASSERT_NEAR(inner.norm(), shell.innerRadius, 1e-5);
      ASSERT_NEAR(outer.norm(), shell.outerRadius, 1e-5);
      ASSERT_NEAR((x - inner).norm(), answers.innerDistance[v], 1e-5);
      ASSERT_NEAR((outer - x).norm(), answers.outerDistance[v], 1e-5);
      ASSERT_NEAR(answers.thickness[v], shell.thickness(), 1e-5);
    }
    ASSERT_NEAR(shell.innerLevel[v], r - shell.innerRadius, 1e-4);
  }
}

TEST(ShellPhantom, TheHarmonicFunctionFallsAsOneOverTheRadius) {
  const Shell shell = makeShell();
  const harmonic::PhantomAnswers answers = harmonic::answersOf(shell);
  const double a = shell.innerRadius, b = shell.outerRadius;
  const Grid& grid = answers.u.grid;
  int count = 0;
  for (std::size_t v = 0; v < answers.u.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const double r = grid.toWorld(Vector(i, j, k)).norm();
    if (r <= a || r >= b) continue;
    EXPECT_NEAR(answers.u[v], b * (r - a) / (r * (b - a)), 1e-6);
    ++count;
  }
  EXPECT_GT(count, 100);
}

TEST(ShellPhantom, RefusesShellsThatCannotBe) {
  ShellOptions options;
  options.innerRadius = 0.9;
  EXPECT_THROW((void)makeShell(options), InvalidInput);
  options = {};
  options.size = 4;
  EXPECT_THROW((void)makeShell(options), InvalidInput);
}

}  // namespace
}  // namespace explica::phantom
