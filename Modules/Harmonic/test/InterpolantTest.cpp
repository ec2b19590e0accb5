// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/Interpolant.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Harmonic/Phantoms.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace explica;
using namespace explica::harmonic;

namespace {

struct Errors {
  double u = 0, boundaryGradient = 0;
  int iterations = 0;
};

Annulus annulusOf(const ExactAnnulus& exact, const Grid& grid, const AnnulusOptions& options = {}) {
  return annulusFromLevels(sampled(grid, exact.innerLevel), sampled(grid, exact.outerLevel),
                           {0, LevelInside::Below}, options);
}

Errors errorsOf(const ExactAnnulus& exact, const Grid& grid, const AnnulusOptions& options = {}) {
  const Annulus annulus = annulusOf(exact, grid, options);
  const Interpolant solved = solveInterpolant(annulus);
  EXPECT_EQ(solved.termination, Termination::Converged);
  Errors errors;
  errors.iterations = solved.iterations;
  const double step = 1e-4;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const Point x = annulus.world(n);
    errors.u = std::max(errors.u, std::abs(solved.u[n] - exact.answer(x).u));
    if (annulus.irregular(n) < 0 && exact.dimension == 3) continue;
    Vector gradient = Vector::Zero();
    for (int a = 0; a < exact.dimension; ++a) {
      const Vector e = step * Vector::Unit(a);
      gradient[a] = (exact.answer(x + e).u - exact.answer(x - e).u) / (2 * step);
    }
    errors.boundaryGradient =
        std::max(errors.boundaryGradient, (gradient - solved.gradient[n].cast<double>()).norm());
  }
  return errors;
}

/// Least-squares slope of log(error) over log(spacing).
double order(const std::vector<double>& spacing, const std::vector<double>& error) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(spacing.size());
  for (std::size_t k = 0; k < spacing.size(); ++k) {
    const double x = std::log(spacing[k]), y = std::log(error[k]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void expectSecondOrder(const ExactAnnulus& exact, double extent, const std::vector<int>& sizes,
                       const Vector& ratio = Vector::Ones(), const AnnulusOptions& options = {}) {
  std::vector<double> spacings, u, gradient;
  for (const int size : sizes) {
    const double h = extent / size;
    std::array<int, 3> n{};
    for (int a = 0; a < 3; ++a) n[a] = static_cast<int>(std::ceil(extent / (h * ratio[a])));
    if (exact.dimension == 2) n[2] = 1;
    const Errors errors = errorsOf(exact, centredGrid(n, h * ratio), options);
    spacings.push_back(h);
    u.push_back(errors.u);
    gradient.push_back(errors.boundaryGradient);
    // The cycle takes care of all wave lengths at once: iterations hardly grow with the grid.
    if (options.boundary != BoundaryModel::Embedding) {
      EXPECT_LE(errors.iterations, 10) << h;
    }
    std::printf("h %.4f  u %.3e  gradient at boundary %.3e  iterations %d\n", h, errors.u,
                errors.boundaryGradient, errors.iterations);
  }
  EXPECT_GE(order(spacings, u), 1.8);
  EXPECT_LE(order(spacings, u), 3.2);
  EXPECT_GE(order(spacings, gradient), 1.0);
}

}  // namespace

TEST(HarmonicInterpolant, IsLinearAcrossASlab) {
  Grid grid = centredGrid({8, 6, 40}, {0.9, 1.3, 0.4});
  Volume<Site> sites(grid, Site::Outer);
  const auto inner = sampled(grid, [](const Point& x) { return x[2] + 4.03; });
  const auto outer = sampled(grid, [](const Point& x) { return x[2] - 5.11; });
  for (std::size_t v = 0; v < sites.size(); ++v) {
    sites[v] = inner[v] <= 0 ? Site::Inner : outer[v] < 0 ? Site::Tissue : Site::Outer;
  }
  const Annulus annulus = annulusFromSites(sites, inner, outer);
  const Interpolant solved = solveInterpolant(annulus);
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    EXPECT_NEAR(solved.u[n], (annulus.world(n)[2] + 4.03) / 9.14, 1e-6);
    EXPECT_NEAR(solved.gradient[n][2], 1 / 9.14, 1e-5);
  }
}

TEST(HarmonicInterpolant, IsOfSecondOrderOnACylinder) {
  expectSecondOrder(exactShell(4.1, 9.3, 2), 21, {32, 64, 128, 256});
}

TEST(HarmonicInterpolant, IsOfSecondOrderOnAShell) {
  expectSecondOrder(exactShell(4.1, 9.3), 21, {24, 40, 64});
}

TEST(HarmonicInterpolant, IsOfSecondOrderOnAShellWithThickSlices) {
  expectSecondOrder(exactShell(4.1, 9.3), 21, {32, 48, 72}, {1, 1, 2.3});
}

TEST(HarmonicInterpolant, IsOfSecondOrderOnEccentricCircles) {
  expectSecondOrder(exactEccentric(4, 10, 3), 22, {40, 80, 160, 320});
}

TEST(HarmonicInterpolant, IsOfSecondOrderOnConfocalSpheroids) {
  expectSecondOrder(exactSpheroids(6, 0.9, 1.4), 22, {64, 96, 144});
}

TEST(HarmonicInterpolant, IsOfSecondOrderOnSlenderSpheroids) {
  // At the tips the inner one's radius of curvature is 2.4 mm, seven voxels of the coarsest grid.
  // The greatest error moves with the grid: neighbouring sizes give orders between 1.6 and 2.1.
  expectSecondOrder(exactSpheroids(6, 0.7, 1.2), 20, {54, 108, 216});
}

TEST(HarmonicEmbedding, IsOfSecondOrderInThePlaneAndInSpace) {
  AnnulusOptions options;
  options.boundary = BoundaryModel::Embedding;
  expectSecondOrder(exactEccentric(4, 10, 3), 22, {40, 80, 160}, Vector::Ones(), options);
  expectSecondOrder(exactShell(4.1, 9.3), 21, {24, 40, 64}, Vector::Ones(), options);
}

TEST(HarmonicInterpolant, ObeysTheMaximumPrincipleExactly) {
  const auto exact = exactEccentric(4, 10, 3);
  const Annulus annulus = annulusOf(exact, centredGrid({150, 150, 1}, {0.15, 0.15, 1}));
  InterpolantOptions loose;
  loose.relativeTolerance = 1e-2;
  for (const auto& options : {loose, InterpolantOptions{}}) {
    for (const double u : solveInterpolant(annulus, options).u) {
      EXPECT_GE(u, 0);
      EXPECT_LE(u, 1);
    }
  }
}

TEST(HarmonicInterpolant, DoesNotDependOnTheNumberOfThreads) {
  const Annulus annulus = annulusOf(exactShell(7, 12), centredGrid({48, 48, 48}, {0.6, 0.6, 0.6}));
  setThreadCount(1);
  const auto one = solveInterpolant(annulus).u;
  setThreadCount(4);
  const auto four = solveInterpolant(annulus).u;
  setThreadCount(0);
  EXPECT_EQ(one, four);
}

TEST(HarmonicInterpolant, KeepsFluxOutOfInsulatedVoxels) {
  // A shell cut by a plane through its centre has the whole shell's interpolant.
  const auto exact = exactShell(7, 12);
  const Grid grid = centredGrid({56, 56, 56}, Vector::Constant(0.5));
  const auto inner = sampled(grid, exact.innerLevel), outer = sampled(grid, exact.outerLevel);
  Volume<std::uint8_t> insulated(grid, 0);
  for (int k = 28; k < 56; ++k) {
    for (int j = 0; j < 56; ++j) {
      for (int i = 0; i < 56; ++i) insulated(i, j, k) = 1;
    }
  }
  for (const auto model : {BoundaryModel::Subvoxel, BoundaryModel::Embedding}) {
    const Annulus annulus =
        annulusFromLevels(inner, outer, {0, LevelInside::Below}, {.boundary = model}, insulated);
    const Interpolant solved = solveInterpolant(annulus);
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
      EXPECT_NEAR(solved.u[n], exact.answer(annulus.world(n)).u, 0.004) << nameOf(model);
    }
  }
}

TEST(HarmonicInterpolant, SolvesEverySliceOnItsOwn) {
  // Circles that move from slice to slice; together the slices would have another interpolant.
  const Grid grid = centredGrid({96, 96, 3}, {0.25, 0.25, 2});
  const ExactAnnulus exact[] = {exactEccentric(4, 10, 0.5), exactEccentric(4, 10, 3),
                                exactEccentric(5, 9, 1)};
  Volume<float> inner(grid), outer(grid);
  for (std::size_t v = 0; v < inner.size(); ++v) {
    const auto s = grid.subscripts(v);
    Point x = grid.toWorld(Vector(s[0], s[1], s[2]));
    x[2] = 0;
    inner[v] = static_cast<float>(exact[s[2]].innerLevel(x));
    outer[v] = static_cast<float>(exact[s[2]].outerLevel(x));
  }
  for (const auto model : {BoundaryModel::Subvoxel, BoundaryModel::Embedding}) {
    const Annulus annulus = annulusFromLevels(inner, outer, {0, LevelInside::Below},
                                              {.boundary = model, .perSlice = true});
    const Interpolant solved = solveInterpolant(annulus);
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
      const auto slice = static_cast<std::size_t>(std::lround(annulus.index(n)[2]));
      Point x = annulus.world(n);
      x[2] = 0;
      EXPECT_NEAR(solved.u[n], exact[slice].answer(x).u, 1e-3)
          << nameOf(model) << ", slice " << slice;
    }
  }
}

TEST(Annulus, SaysWhichLabelsTheFileHas) {
  Volume<Label> labels(centredGrid({8, 8, 8}, Vector::Ones()), 0);
  labels(3, 3, 3) = 7;
  try {
    (void)annulusFromLabels(labels, {{1}, {7}, {}, {}});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("label 1 is absent; the file has 0, 7"),
              std::string::npos)
        << error.what();
  }
}

TEST(Annulus, LabelsThatAreAbsentBesideOthersOfTheirListAreNamed) {
  Volume<Label> labels(centredGrid({12, 12, 24}, Vector(2, 2, 1)), 0);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto [i, j, k] = labels.grid.subscripts(v);
    const double r = labels.grid.toWorld(Vector(i, j, k)).norm();
    labels[v] = r < 5 ? 1 : r < 9 ? 2 : 0;
  }
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.onWarning = [&](const std::string& message) { warnings.push_back(message); };
  const Annulus found = annulusFromLabels(labels, {{4, 1, 5}, {2}, {}, {}}, {}, monitor);
  const Annulus asked = annulusFromLabels(labels, {{1}, {2}, {}, {}});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("label 4, 5 is absent"), std::string::npos) << warnings[0];
  EXPECT_EQ(found.place, asked.place);
  EXPECT_EQ(found.fractions, asked.fractions);
}

TEST(Annulus, RefusesTissueThatTouchesOneSideOnly) {
  Volume<Label> labels(centredGrid({12, 12, 12}, Vector::Ones()), 0);
  labels(2, 2, 2) = 1;
  for (int k = 6; k < 9; ++k) labels(6, 6, k) = 2;
  EXPECT_THROW((void)annulusFromLabels(labels, {{1}, {2}, {}, {}}), InvalidInput);
}

/// A ball in a ball, both cut by the image's edge.
Volume<Label> ballsAtTheEdge() {
  Grid grid;
  grid.size = {23, 17, 13};
  grid.spacing = {0.5, 1, 1.5};
  grid.origin = {3, -4, 5};
  Volume<Label> labels(grid, 0);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    const double distance = (Vector(s[0], s[1], s[2]) - Vector(16, 9, 3)).norm();
    labels[v] = distance < 4 ? 1 : distance < 8 ? 2 : 0;
  }
  return labels;
}

TEST(Annulus, FieldsOfTheTissueStandAtTheirVoxelsInWhateverPiecesTheyAreAskedFor) {
  const Volume<Label> labels = ballsAtTheEdge();
  const Annulus annulus = annulusFromLabels(labels, {{1}, {2}, {}, {}});
  std::vector<double> values(annulus.count());
  std::vector<int> numbers(annulus.count());
  std::vector<Eigen::Vector3f> offsets(annulus.count(), Eigen::Vector3f(0.125F, -0.25F, 0.5F));
  for (std::size_t n = 0; n < values.size(); ++n) {
    values[n] = n % 7 == 0 ? kNaN : 0.5 * static_cast<double>(n);
    numbers[n] = static_cast<int>(n % 90) - 30;
  }
  const auto blank = spread(annulus, values), sides = spread(annulus, values, -3, -1, -2);
  const auto whole = spreadLabels(annulus, numbers);
  const auto points = spreadPoints(annulus, offsets);
  EXPECT_EQ(*whole.range, (std::array<Label, 2>{-30, 59}));
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{400}}) {
    for (std::size_t first = 0; first < labels.size(); first += piece) {
      const std::size_t count = std::min(piece, labels.size() - first);
      std::vector<float> a(count), b(count), x(count), z(count);
      std::vector<Label> c(count);
      blank.fill(first, count, a.data());
      sides.fill(first, count, b.data());
      whole.fill(first, count, c.data());
      points[0].fill(first, count, x.data());
      points[2].fill(first, count, z.data());
      for (std::size_t t = 0; t < count; ++t) {
        const auto s = labels.grid.subscripts(first + t);
        const auto* at = annulus.numberAt.data();
        std::int32_t n = kOuter;
        bool inBox = true;
        std::array<std::int32_t, 3> inside{};
        for (int axis = 0; axis < 3; ++axis) {
          inside[axis] = s[axis] - annulus.first[axis];
          inBox = inBox && inside[axis] >= 0 && inside[axis] < annulus.size[axis];
        }
        if (inBox) {
          n = at[inside[0] + annulus.size[0] * (inside[1] + annulus.size[1] * inside[2])];
        }
        const bool tissue = n >= 0, known = tissue && !std::isnan(values[n]);
        const float side = n == kInner ? -1 : n == kOuter ? -2 : -3;
        ASSERT_EQ(a[t], known ? static_cast<float>(values[n]) : 0) << first + t;
        ASSERT_EQ(b[t], known ? static_cast<float>(values[n]) : tissue ? -3 : side) << first + t;
        ASSERT_EQ(c[t], tissue ? numbers[n] : 0) << first + t;
        ASSERT_EQ(x[t], tissue ? static_cast<float>(3 + 0.5 * s[0] + 0.125) : 0) << first + t;
        ASSERT_EQ(z[t], tissue ? static_cast<float>(5 + 1.5 * s[2] + 0.5) : 0) << first + t;
      }
    }
  }
}

TEST(Annulus, LabelsThatAreGivenAwayAreFreedAndGiveTheSame) {
  Volume<Label> labels = ballsAtTheEdge();
  const Annulus kept = annulusFromLabels(labels, {{1}, {2}, {}, {}});
  const Annulus given = annulusFromLabels(std::move(labels), {{1}, {2}, {}, {}});
  EXPECT_EQ(labels.data.capacity(), 0U);  // NOLINT(bugprone-use-after-move): what it promises
  EXPECT_EQ(given.numberAt, kept.numberAt);
  EXPECT_EQ(given.links, kept.links);
  EXPECT_EQ(given.fractions, kept.fractions);
}

TEST(Annulus, RefusesAVoxelSizeOfZero) {
  Volume<Label> labels(centredGrid({4, 4, 4}, Vector::Ones()), 0);
  labels.grid.spacing[1] = 0;
  EXPECT_THROW((void)annulusFromLabels(labels, {{1}, {2}, {}, {}}), InvalidInput);
}

/// A pin's hole, as every cortex has some, is counted; a wider one is said with its place.
TEST(Annulus, ReportsAHoleThatJoinsInsideAndOutside) {
  const auto shell = makePhantom(PhantomKind::Shell, {64, 1}).labels;
  for (const int width : {1, 5}) {
    auto labels = shell;
    for (int i = 32; i < 64; ++i) {
      for (int k = 0; k < width * width; ++k) {
        Label& label = labels(i, 32 + k % width, 32 + k / width);
        if (label == 2) label = 0;
      }
    }
    std::vector<std::string> warnings;
    Monitor monitor;
    monitor.onWarning = [&](const std::string& text) { warnings.push_back(text); };
    const Annulus annulus = annulusFromLabels(labels, {{1}, {2}, {}, {}}, {}, monitor);
    EXPECT_EQ(annulus.holes, 1);
    EXPECT_EQ(annulus.ends, 0);
    ASSERT_EQ(warnings.size(), width == 1 ? 0U : 1U);
    if (width == 1) {
      EXPECT_EQ(annulus.directContacts, 1U);
      continue;
    }
    EXPECT_NE(warnings[0].find(" voxel faces, at voxel ("), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find(", 32, 32)"), std::string::npos) << warnings[0];
  }
}

/// As cortex ends around the medial wall.
TEST(Annulus, ATissueThatEndsHasNoHole) {
  auto labels = makePhantom(PhantomKind::Shell, {64, 1}).labels;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    if (labels[v] == 2 && labels.grid.subscripts(v)[2] > 38) labels[v] = 0;
  }
  bool warned = false;
  Monitor monitor;
  monitor.onWarning = [&](const std::string&) { warned = true; };
  const Annulus annulus = annulusFromLabels(labels, {{1}, {2}, {}, {}}, {}, monitor);
  EXPECT_GT(annulus.directContacts, 500U);
  EXPECT_EQ(annulus.holes, 0);
  EXPECT_EQ(annulus.ends, 1);
  EXPECT_FALSE(warned);
}
