// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Surface/Remesh.h"
#include "Explica/Surface/Summary.h"
#include "NearestToItself.h"
#include "VoxelAndVertex.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>

namespace explica::surface {
namespace {

/// Centred lattice with oblique axes; spacing in mm.
Grid lattice(int n, const Vector& spacing) {
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing = spacing;
  grid.direction << std::cos(0.3), -std::sin(0.3), 0, std::sin(0.3), std::cos(0.3), 0, 0, 0, 1;
  grid.origin = -(grid.direction * (0.5 * (n - 1) * spacing));
  return grid;
}

template <class Value>
auto volumeOf(const Grid& grid, const Value& value) {
  using T = decltype(value(Point()));
  Volume<T> volume(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const auto s = grid.subscripts(v);
    volume[v] = value(grid.toWorld(Vector(s[0], s[1], s[2])));
  }
  return volume;
}

/// Share of the ball of radius r in a voxel, to first order.
float shareOf(const Point& p, double r, double h) {
  return static_cast<float>(std::clamp(0.5 + (r - p.norm()) / h, 0.0, 1.0));
}

CorticalTissue shell(double inner, double outer, double h) {
  const int n = static_cast<int>(2 * (outer + 4 * h) / h);
  const Grid grid = lattice(n, Vector::Constant(h));
  return tissueFromShares(volumeOf(grid, [&](const Point& p) { return shareOf(p, inner, 4 * h); }),
                          volumeOf(grid, [&](const Point& p) { return shareOf(p, outer, 4 * h); }));
}

/// Two folds: a ball whose radius waves, as labels 3 (white) in a ribbon 2.
Volume<Label> foldedLabels(double h) {
  const int n = static_cast<int>(56 / h);
  return volumeOf(lattice(n, Vector::Constant(h)), [](const Point& p) -> Label {
    const double r = p.norm();
    const double wave = 3.2 * std::sin(6 * std::atan2(p.y(), p.x())) *
                        std::pow(std::hypot(p.x(), p.y()) / std::max(r, 1e-9), 2);
    if (r < 16 + wave) return 3;
    return r < 18.5 + 0.4 * wave || r < 18.5 + wave ? 2 : 0;
  });
}

void expectSound(const TriangleMesh& mesh) {
  // What is checked is what a file of float32 numbers holds.
  for (const double x : mesh.positions.reshaped()) EXPECT_EQ(x, static_cast<float>(x));
  const auto condition = geometry::inspectMesh(mesh);
  EXPECT_TRUE(condition.closedManifold());
  EXPECT_EQ(condition.eulerCharacteristic, 2);
  EXPECT_EQ(condition.components, 1);
  EXPECT_TRUE(geometry::findSelfIntersections(mesh).empty());
  EXPECT_GT(geometry::enclosedVolume(mesh), 0);
}

/// Distances of a surface's vertices from a sphere about the origin.
Eigen::VectorXd offSphere(const TriangleMesh& mesh, double radius) {
  return mesh.positions.rowwise().norm().array() - radius;
}

TEST(LevelSet, OfABallsMaskIsASphere) {
  struct Case {
    Vector spacing;
    double meanSquared, most;  // in voxels of the coarsest axis
  };
  for (const auto& [spacing, meanSquared, most] :
       {Case{{1, 1, 1}, 0.08, 0.25}, Case{{0.6, 0.6, 1.2}, 0.06, 0.25}}) {
    const double radius = 14.3;
    const auto ball = volumeOf(lattice(64, spacing), [&](const Point& p) -> std::uint8_t {
      return p.norm() < radius ? 1 : 0;
    });
    const auto level = levelSetOf(ball);
    const Eigen::VectorXd off =
        offSphere(geometry::extractIsoSurface(level), radius) / spacing.maxCoeff();
    EXPECT_LE(std::sqrt(off.squaredNorm() / static_cast<double>(off.size())), meanSquared);
    EXPECT_LE(off.cwiseAbs().maxCoeff(), most);
    for (std::size_t v = 0; v < ball.size(); ++v) {
      ASSERT_EQ(level[v] > 0, ball[v] != 0);
      ASSERT_LE(std::abs(level[v]), 1);
    }
  }
}

TEST(LevelSet, OfATiltedHalfSpacesMaskIsThePlane) {
  const Grid grid = lattice(48, Vector(1, 0.8, 1.4));
  const Vector normal = Vector(0.55, 0.3, 0.8).normalized();
  const double offset = 1.37;
  const auto level = levelSetOf(volumeOf(
      grid, [&](const Point& p) -> std::uint8_t { return normal.dot(p) < offset ? 1 : 0; }));
  const Vector along = normal.cross(Vector::UnitX()).normalized(), across = normal.cross(along);
  // The level is the distance, in two of the coarsest voxels.
  for (const double distance : {-0.7, -0.4, 0.4, 0.7}) {
    for (double a = -8; a <= 8; a += 1.3) {
      const auto near = sample(level, (offset - distance) * normal + a * along);
      EXPECT_NEAR(2 * 1.4 * near.value, distance, 0.12);
    }
  }
  double squared = 0;
  int count = 0;
  for (double a = -8; a <= 8; a += 0.7) {
    for (double b = -8; b <= 8; b += 0.7) {
      const auto here = sample(level, offset * normal + a * along + b * across);
      const double distance = here.value / here.gradient.norm();
      squared += distance * distance;
      ++count;
      EXPECT_LE(std::abs(distance), 0.15);
      EXPECT_GE(-here.gradient.normalized().dot(normal), std::cos(0.2));
    }
  }
  EXPECT_LE(std::sqrt(squared / count), 0.05);
}

TEST(LevelSet, KeepsASheetOfOneVoxelAsThickAsAVoxel) {
  Grid grid;
  grid.size = {16, 16, 11};
  Volume<std::uint8_t> sheet(grid, 0);
  for (int j = 0; j < 16; ++j) {
    for (int i = 0; i < 16; ++i) sheet(i, j, 5) = 1;
  }
  const auto level = levelSetOf(sheet);
  EXPECT_NEAR(level(8, 8, 5), 0.25, 1e-3);
  EXPECT_NEAR(level(8, 8, 4), -0.25, 1e-3);
  EXPECT_NEAR(level(8, 8, 6), -0.25, 1e-3);
}

TEST(Remesh, MakesEvenTrianglesAndMeetsTheCount) {
  const auto tissue = shell(12, 15, 1);
  const auto iso = geometry::extractIsoSurface(tissue.white);
  for (const std::int64_t faces : {1000, 8000, 20000}) {
    SCOPED_TRACE(faces);
    RemeshOptions options;
    options.faces = faces;
    const auto result = remesh(iso, tissue.white, options);
    expectSound(result.mesh);
    EXPECT_EQ(result.mesh.faceCount(), faces);
    const auto angles = geometry::smallestAnglesRad(result.mesh);
    std::vector<double> sorted(angles.begin(), angles.end());
    std::sort(sorted.begin(), sorted.end());
    EXPECT_GT(sorted[sorted.size() / 20] * 180 / kPi, 40);
    EXPECT_GT(sorted.front() * 180 / kPi, 15);
  }
  RemeshOptions few;
  few.faces = 10;
  EXPECT_THROW((void)remesh(iso, tissue.white, few), InvalidInput);
}

TEST(Remesh, MakesNoMoreTrianglesThanTheVolumeCanTell) {
  // A ball of nine voxels across: what 150,000 faces would have in their way took minutes.
  const auto tissue = shell(4.5, 7, 1);
  const auto iso = geometry::extractIsoSurface(tissue.white);
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.onWarning = [&](const std::string& message) { warnings.push_back(message); };
  const auto result = remesh(iso, tissue.white, {}, monitor);
  expectSound(result.mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("150000 faces asked"), std::string::npos);
  EXPECT_NEAR(result.edgeLength, 0.2, 0.03);
  // Edges of a fifth of a voxel on 4 pi 4.5^2 voxels.
  EXPECT_NEAR(static_cast<double>(result.mesh.faceCount()), 4 / std::sqrt(3.0) * 254.5 / 0.04, 700);
}

TEST(Remesh, ConvergesToTheSphereAtSecondOrder) {
  double error[3];
  for (int s = 0; s < 3; ++s) {
    const double h = 1.6 / (1 << s);
    const auto tissue = shell(12.13, 15, h);
    RemeshOptions options;
    options.faces = 1000 << (2 * s);
    const auto mesh = remesh(geometry::extractIsoSurface(tissue.white), tissue.white, options).mesh;
    error[s] = std::abs(geometry::enclosedVolume(mesh) / (4.0 / 3 * kPi * std::pow(12.13, 3)) - 1);
  }
  EXPECT_NEAR(0.5 * std::log2(error[0] / error[2]), 2, 0.4);
}

TEST(CorticalSurface, TrajectoriesBendToMeetTheOuterBoundaryAtRightAngles) {
  // Between eccentric spheres the normals of the inner one miss those of the outer one.  Arcs of
  // circles that meet both at right angles leave the normal by half the angle between the two.
  const Point centre(0, 0, 4);
  const Grid grid = lattice(48, Vector(1, 1, 1));
  const auto tissue =
      tissueFromShares(volumeOf(grid, [&](const Point& p) { return shareOf(p, 8, 4); }),
                       volumeOf(grid, [&](const Point& p) { return shareOf(p - centre, 16, 4); }));
  SurfaceOptions options;
  options.faces = 4000;
  const auto made = buildSurfaces(tissue, options);
  double bent = 0, expected = 0;
  for (int v = 0; v < made.white.mesh.vertexCount(); ++v) {
    const Point w = made.white.mesh.positions.row(v), p = made.pial.positions.row(v);
    const Vector inner = w.normalized(), outer = (p - centre).normalized();
    const Vector away = -(Vector::UnitZ() - inner.z() * inner);  // from the thick side
    if (away.norm() < 0.5) continue;
    bent += (p - w).dot(away.normalized());
    expected += (p - w).norm() * std::sin(0.5 * std::acos(std::clamp(inner.dot(outer), -1.0, 1.0)));
  }
  EXPECT_GT(expected / made.white.mesh.vertexCount(), 0.3);
  EXPECT_NEAR(bent / expected, 1, 0.2);
}

TEST(CorticalSurface, FindsTheThicknessOfAShell) {
  const auto tissue = shell(14, 17, 1);
  SurfaceOptions options;
  options.faces = 6000;
  const auto made = buildSurfaces(tissue, options);
  for (const TriangleMesh* mesh : {&made.white.mesh, &made.mid, &made.pial}) expectSound(*mesh);
  EXPECT_EQ(made.noRibbon, 0);
  EXPECT_EQ(made.heldBackPial, 0);
  EXPECT_NEAR(made.thickness.mean(), 3, 0.03);
  EXPECT_LT((made.thickness.array() - 3).abs().maxCoeff(), 0.15);
  for (Eigen::Index v = 0; v < made.pial.vertexCount(); ++v) {
    // Trajectories are radii.
    const Vector white = made.white.mesh.positions.row(v), pial = made.pial.positions.row(v);
    EXPECT_GT(white.normalized().dot(pial.normalized()), std::cos(0.02));
    EXPECT_NEAR(made.mid.positions.row(v).norm(), 15.5, 0.12);
  }
  EXPECT_NEAR(made.curvature.mean(), -1.0 / 14, 0.005);
}

/// A ball of white matter with a groove along z, as labels: banks at `halfAngle` to its middle,
/// a round bottom at y = 3 of 3 mm radius, grey matter from bank to bank.
Volume<Label> groovedLabels(double halfAngle) {
  constexpr double kMiddle = 6, kRadius = 3;
  const double apex = kMiddle - kRadius / std::sin(halfAngle);
  return volumeOf(lattice(56, Vector::Constant(1)), [&](const Point& p) -> Label {
    if (p.norm() > 25) return 0;
    const bool round = p.y() < kMiddle - kRadius * std::sin(halfAngle);
    const bool groove =
        round ? std::hypot(p.x(), p.y() - kMiddle) < kRadius
              : std::abs(p.x()) * std::cos(halfAngle) < (p.y() - apex) * std::sin(halfAngle);
    return groove || p.norm() > 22 ? 2 : 3;
  });
}

TEST(CorticalSurface, TrajectoriesEndWhereTheFloorOfABuriedSulcusBegins) {
  // Banks that face each other at 142 degrees: whatever leaves the bottom meets their middle at the
  // centre of the bottom's curvature, 3 mm on, and must not follow it up towards the fluid.
  TissueOptions options;
  options.white = {3};
  options.grey = {2};
  SurfaceOptions few;
  few.faces = 12000;
  const auto made = buildSurfaces(tissueFromLabels(groovedLabels(19 * kPi / 180), options), few);
  // The middle's lower edge is known to a voxel: between the lowest two neighbours that fronts from
  // opposite banks reach.
  double sum = 0, way = 0;
  int bottom = 0;
  for (Eigen::Index v = 0; v < made.white.mesh.vertexCount(); ++v) {
    const Point p = made.white.mesh.positions.row(v);
    if (std::abs(p.z()) > 8 || std::hypot(p.x(), p.y() - 3) > 1.5) continue;
    EXPECT_LT(made.thickness[v], 4) << p.transpose();
    sum += made.thickness[v];
    way += (made.pial.positions.row(v) - made.white.mesh.positions.row(v)).norm();
    ++bottom;
  }
  EXPECT_GT(bottom, 10);
  EXPECT_NEAR(sum / bottom, 3.25, 0.35);
  EXPECT_NEAR(way / bottom, 3.25, 0.35);
}

TEST(CorticalSurface, HasTheThicknessOfTheVoxelMap) {
  TissueOptions options;
  options.white = {3};
  options.grey = {2};
  SurfaceOptions few;
  few.faces = 12000;
  const TissueMasks masks = masksFromLabels(groovedLabels(19 * kPi / 180), options);
  const auto both = compare("groove", masks, buildSurfaces(tissueFromMasks(masks), few));
  EXPECT_GT(both.share, 0.9);
  EXPECT_GE(both.r, 0.98);
  EXPECT_LE(std::abs(both.mean), 0.01);
  EXPECT_LE(both.absolute, 0.05);
  EXPECT_NEAR(both.meanOfVoxels, both.meanOfVertices, 0.02);
}

/// Turned by 90 degrees about an axis.
Volume<Label> turned(const Volume<Label>& labels, int axis) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  Grid grid = labels.grid;
  std::swap(grid.size[a], grid.size[b]);
  std::swap(grid.spacing[a], grid.spacing[b]);
  Volume<Label> result(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    auto at = labels.grid.subscripts(v);
    const int low = at[b], high = labels.grid.size[a] - 1 - at[a];
    at[a] = low;
    at[b] = high;
    result(at[0], at[1], at[2]) = labels[v];
  }
  return result;
}

/// On voxels of half the size, its borders where the labels' level sets have them.
Volume<Label> finer(const Volume<Label>& labels, Label white, Label grey) {
  const auto levelOf = [&](const std::vector<Label>& of) {
    return levelSetOf(harmonic::maskOf(labels, of));
  };
  const LevelSet inner = levelOf({white}), outer = levelOf({white, grey});
  Grid grid = labels.grid;
  grid.origin -= 0.25 * (grid.direction * grid.spacing);
  grid.spacing *= 0.5;
  for (int& n : grid.size) n *= 2;
  Volume<Label> result(grid);
  for (std::size_t v = 0; v < result.size(); ++v) {
    const auto at = grid.subscripts(v);
    const Point x = grid.toWorld(Vector(at[0], at[1], at[2]));
    result[v] = sample(inner, x).value > 0 ? white : sample(outer, x).value > 0 ? grey : Label{0};
  }
  return result;
}

TEST(CorticalSurface, MeanThicknessIsFreeOfSampling) {
  TissueOptions options;
  options.white = {3};
  options.grey = {2};
  const auto meanOf = [&](const Volume<Label>& labels, int faces) {
    SurfaceOptions many;
    many.faces = faces;
    const auto made = buildSurfaces(tissueFromLabels(labels, options), many);
    const double mean = meanThickness(made.columns.area, made.columns.thickness);
    std::printf("%d faces, voxels of %g mm: mean thickness %.4f mm\n", faces,
                labels.grid.spacing[0], mean);
    return mean;
  };
  const Volume<Label> labels = groovedLabels(19 * kPi / 180);
  const double mean = meanOf(labels, 12000);
  for (const int faces : {5000, 40000}) EXPECT_NEAR(meanOf(labels, faces), mean, 0.01) << faces;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(meanOf(turned(labels, axis), 12000), mean, 0.02) << axis;
  }
  EXPECT_NEAR(meanOf(finer(labels, 3, 2), 12000), mean, 0.02);
}

/// Brightness at signed distances to white matter's and the tissue's border, mm, positive inside,
/// seen through a point spread.
float brightnessAt(double white, double tissue) {
  const auto step = [](double x) { return 0.5 * (1 + std::erf(x / (0.6 * std::sqrt(2.0)))); };
  return static_cast<float>(20 + 60 * step(tissue) + 30 * step(white));
}

TEST(CorticalSurface, MeanThicknessByAnImageIsFreeOfTheFaces) {
  TissueOptions options;
  options.white = {3};
  options.grey = {2};
  const CorticalTissue tissue = tissueFromLabels(groovedLabels(19 * kPi / 180), options);
  // White matter ends 0.4 mm farther in than the labels say, on one side.
  const LevelSet white = distanceLevelOf(tissue.white), outer = distanceLevelOf(tissue.tissue);
  const double band = bandOf(white.grid);
  Volume<float> image(white.grid);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto at = white.grid.subscripts(v);
    const double in = white.grid.toWorld(Vector(at[0], at[1], at[2])).x() > 0 ? 0.4 : 0;
    image[v] = brightnessAt(band * white[v] - in, band * outer[v]);
  }
  const auto meanOf = [&](int faces) {
    SurfaceOptions many;
    many.faces = faces;
    const auto made = buildSurfaces(tissue, image, many);
    EXPECT_GT(made.image.movedWhite, 0.05);
    EXPECT_EQ(made.image.doubt.rows(), made.thickness.size());
    EXPECT_LE(made.image.missingWhite, made.thickness.size());
    const double mean = meanThickness(made.columns.area, made.columns.thickness);
    std::printf("%d faces: mean thickness %.4f mm\n", faces, mean);
    return mean;
  };
  const double mean = meanOf(12000);
  for (const int faces : {3000, 40000}) EXPECT_NEAR(meanOf(faces), mean, 0.01) << faces;
}

/// Brightness of a shell seen through a point spread: white, grey, dark, and a bright vessel
/// beyond.
float brightness(const Point& p, double inner, double outer) {
  const auto step = [](double x) { return 0.5 * (1 + std::erf(x / (0.6 * std::sqrt(2.0)))); };
  const double r = p.norm();
  const double vessel = 60 * std::exp(-0.5 * std::pow((p - Point(0, 0, outer + 3)).norm(), 2));
  return static_cast<float>(20 + 60 * step(outer - r) + 30 * step(inner - r) + vessel);
}

TEST(CorticalSurface, AnImagePlacesTheBordersOfAShell) {
  // Labels say 14 and 17 mm; the image, 14.4 and 16.7.
  CorticalTissue tissue = shell(14, 17, 1);
  tissue.byBrightness = false;
  const auto image = volumeOf(lattice(56, Vector::Constant(0.8)),
                              [](const Point& p) { return brightness(p, 14.4, 16.7); });
  auto inverse = image;
  for (float& value : inverse.data) value = 200 - value;
  SurfaceOptions options;
  options.faces = 6000;
  for (const Volume<float>& seen : {image, inverse}) {
    const auto made = buildSurfaces(tissue, seen, options);
    for (const TriangleMesh* mesh : {&made.white.mesh, &made.mid, &made.pial}) expectSound(*mesh);
    // The labels keep a say: a third of the way is enough.
    EXPECT_GT(offSphere(made.white.mesh, 14).mean(), 0.13);
    EXPECT_LT(offSphere(made.white.mesh, 14.4).mean(), 0.05);
    EXPECT_LT(offSphere(made.pial, 17).mean(), -0.1);
    EXPECT_GT(offSphere(made.pial, 16.7).mean(), -0.05);
    EXPECT_EQ(made.image.missingWhite, 0);
    EXPECT_EQ(made.image.missingOuter, 0);
  }
}

TEST(CorticalSurface, AWhiteBorderThatOneBrightnessPutIntoBrightCortexIsFound) {
  // Upwards, grey matter comes near to white matter's brightness, and the shares' white border lies
  // 1.8 mm too far out.
  const auto bright = [](const Point& p) {
    const double x = std::clamp(2 * p.z() / p.norm() - 0.5, 0.0, 1.0);
    return x * x * (3 - 2 * x);
  };
  const Grid grid = lattice(44, Vector::Constant(1));
  const auto image = volumeOf(grid, [&](const Point& p) {
    const auto step = [](double x) { return 0.5 * (1 + std::erf(x / (0.6 * std::sqrt(2.0)))); };
    const double r = p.norm(), grey = 80 + 20 * bright(p);
    return static_cast<float>(20 + (grey - 20) * step(17 - r) + (110 - grey) * step(14 - r));
  });
  CorticalTissue tissue = tissueFromShares(
      volumeOf(grid, [&](const Point& p) { return shareOf(p, 14 + 1.8 * bright(p), 4); }),
      volumeOf(grid, [&](const Point& p) { return shareOf(p, 17, 4); }));
  SurfaceOptions options;
  options.faces = 6000;
  const auto errors = [&] {  // mean distance from the border: where cortex is bright, elsewhere
    const auto made = buildSurfaces(tissue, image, options);
    expectSound(made.white.mesh);
    std::array<double, 2> sum = {}, count = {};
    for (Eigen::Index v = 0; v < made.white.mesh.vertexCount(); ++v) {
      const Point p = made.white.mesh.positions.row(v);
      const int where = bright(p) > 0.9 ? 0 : 1;
      sum[where] += std::abs(p.norm() - 14);
      count[where] += 1;
    }
    return std::array{sum[0] / count[0], sum[1] / count[1]};
  };
  const auto found = errors();
  EXPECT_LT(found[0], 0.3);
  EXPECT_LT(found[1], 0.2);
  tissue.byBrightness = false;  // labels are right to a voxel
  EXPECT_GT(errors()[0], 0.7);
}

/// Mean distance of the white surface from its border, mm, where cortex is bright and elsewhere.
/// As in motor cortex: upwards, a thick cortex is hardly darker than white matter and equally so
/// all through, and the shares' border lies 2.5 mm too far out: no level leads back from there.
/// @param blur     deviation of the point spread, mm
/// @param masked   the image is 0 beyond the cortex
/// @param spacing  of the voxels, mm
std::array<double, 2> offInEvenCortex(double blur, bool masked,
                                      const Vector& spacing = Vector::Ones()) {
  const auto bright = [](const Point& p) {
    const double x = std::clamp(4 * p.z() / p.norm() - 2, 0.0, 1.0);
    return x * x * (3 - 2 * x);
  };
  const Grid grid = lattice(48, spacing);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, 1);
  const auto image = volumeOf(grid, [&](const Point& p) {
    const auto step = [&](double x) { return 0.5 * (1 + std::erf(x / (blur * std::sqrt(2.0)))); };
    const double r = p.norm(), grey = 83 + 20 * bright(p), outer = 17 + bright(p);
    const double seen = 40 + (grey - 40) * step(outer - r) + (110 - grey) * step(14 - r);
    return masked && r > outer ? 0 : static_cast<float>(seen + noise(generator));
  });
  const CorticalTissue tissue = tissueFromShares(
      volumeOf(grid, [&](const Point& p) { return shareOf(p, 14 + 2.5 * bright(p), 4); }),
      volumeOf(grid, [&](const Point& p) { return shareOf(p, 17 + bright(p), 4); }));
  SurfaceOptions options;
  options.faces = 6000;
  const auto made = buildSurfaces(tissue, image, options);
  expectSound(made.white.mesh);
  std::array<double, 2> sum = {}, count = {};
  for (Eigen::Index v = 0; v < made.white.mesh.vertexCount(); ++v) {
    const Point p = made.white.mesh.positions.row(v);
    const int where = bright(p) == 1 ? 0 : 1;
    sum[where] += std::abs(p.norm() - 14);
    count[where] += 1;
  }
  std::printf("off the border: %.3f mm where cortex is bright, %.3f mm elsewhere\n",
              sum[0] / count[0], sum[1] / count[1]);
  return {sum[0] / count[0], sum[1] / count[1]};
}

TEST(CorticalSurface, AWhiteBorderIsFoundAcrossACortexOfEvenBrightness) {
  const auto found = offInEvenCortex(0.6, false);
  EXPECT_LT(found[0], 0.3);
  EXPECT_LT(found[1], 0.2);
}

TEST(CorticalSurface, APartVoxelAtTheMasksEdgeIsNoWhiteBorder) {
  // The voxels there are part fluid: of the falls that are seen the steepest.
  for (const Vector& spacing : {Vector(1, 1, 1), Vector(0.8, 0.8, 1.4), Vector(1.3, 1, 1)}) {
    const auto whole = offInEvenCortex(0.9, false, spacing);
    const auto masked = offInEvenCortex(0.9, true, spacing);
    EXPECT_LT(masked[0], whole[0] + 0.15) << spacing.transpose();
    EXPECT_LT(masked[1], whole[1] + 0.15) << spacing.transpose();
  }
}

TEST(CorticalSurface, CortexThatWasAllTakenForWhiteMatterIsFound) {
  // Upwards, the shares have white matter up to the fluid where the image shows 2.5 mm of bright
  // cortex.  Downwards there is none, as at a medial wall, and none may be made.
  const auto up = [](const Point& p) { return p.z() / p.norm(); };
  const auto hasNone = [&](const Point& p) { return up(p) < -0.8; };
  const auto outer = [&](const Point& p) { return hasNone(p) ? 14.0 : 16.5; };
  const auto inner = [&](const Point& p) { return up(p) > 0.95 ? 16.5 : 14.0; };
  for (const Vector& spacing : {Vector(1, 1, 1), Vector(0.8, 0.8, 1.4), Vector(1.3, 1, 1)}) {
    const Grid grid = lattice(48, spacing);
    const auto image = volumeOf(grid, [&](const Point& p) {
      const auto step = [](double x) { return 0.5 * (1 + std::erf(x / (0.6 * std::sqrt(2.0)))); };
      const double r = p.norm(), grey = up(p) > 0.95 ? 95 : 83;
      return static_cast<float>(40 + (grey - 40) * step(outer(p) - r) +
                                (110 - grey) * step(14 - r));
    });
    const CorticalTissue tissue =
        tissueFromShares(volumeOf(grid, [&](const Point& p) { return shareOf(p, inner(p), 4); }),
                         volumeOf(grid, [&](const Point& p) { return shareOf(p, outer(p), 4); }));
    SurfaceOptions options;
    options.faces = 6000;
    const auto made = buildSurfaces(tissue, image, options);
    expectSound(made.white.mesh);
    std::array<double, 2> sum = {}, count = {};
    for (Eigen::Index v = 0; v < made.thickness.size(); ++v) {
      const double z = up(made.mid.positions.row(v));
      if (z < 0.96 && z > -0.9) continue;
      sum[z < 0] += made.thickness[v];
      ++count[z < 0];
    }
    EXPECT_NEAR(sum[0] / count[0], 2.5, 0.6) << spacing.transpose();
    EXPECT_EQ(sum[1], 0) << spacing.transpose();
  }
}

TEST(CorticalSurface, ASecondImageShowsDuraThatTheFirstDoesNot) {
  // Upwards, dura as bright as grey matter lies on the cortex without fluid between, and the labels
  // took half a millimetre of it for cortex.  In the second image it is dark, and fluid is bright,
  // or dark, too.
  const Grid grid = lattice(56, Vector::Constant(0.8));
  const auto step = [](double x) { return 0.5 * (1 + std::erf(x / (0.6 * std::sqrt(2.0)))); };
  const auto seen = [&](double white, double grey, double dura, double fluid) {
    return volumeOf(grid, [&, white, grey, dura, fluid](const Point& p) {
      const double r = p.norm(), wide = p.z() > 8 ? 19 : 17;
      return static_cast<float>(fluid + (dura - fluid) * step(wide - r) +
                                (grey - dura) * step(17 - r) + (white - grey) * step(14 - r));
    });
  };
  CorticalTissue tissue = tissueFromShares(
      volumeOf(grid, [](const Point& p) { return shareOf(p, 14, 4); }),
      volumeOf(grid, [](const Point& p) { return shareOf(p, p.z() > 8 ? 17.5 : 17, 4); }));
  tissue.byBrightness = false;
  const Volume<float> t1 = seen(110, 75, 75, 25);
  const Volume<float> t2 = seen(75, 105, 10, 200), flair = seen(85, 105, 10, 15);
  SurfaceOptions options;
  options.faces = 6000;
  const auto beyond = [&](BorderImages images) {  // mean, mm, below the dura
    const auto made = buildSurfaces(tissue, std::move(images), options);
    expectSound(made.pial);
    double sum = 0, count = 0;
    for (Eigen::Index v = 0; v < made.pial.vertexCount(); ++v) {
      const Point p = made.pial.positions.row(v);
      if (p.z() < 11) continue;
      sum += p.norm() - 17;
      count += 1;
    }
    return sum / count;
  };
  const double alone = beyond(t1);
  EXPECT_GT(alone, 0.4);
  EXPECT_LT(beyond({t1, t2}), 0.6 * alone);  // the labels keep a say
  EXPECT_LT(beyond({t1, flair}), 0.6 * alone);
}

TEST(CorticalSurface, AnOuterBorderBeyondASinussWallIsFound) {
  // Upwards, a wall as bright as dark grey matter lies on the cortex, 5 mm thick, with cerebellum
  // beyond, and the shares take the wall for tissue.
  const auto covered = [](const Point& p) {
    const double x = std::clamp(4 * p.z() / p.norm() - 2, 0.0, 1.0);
    return x * x * (3 - 2 * x);
  };
  const Grid grid = lattice(54, Vector::Constant(1));
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, 2);
  const auto image = volumeOf(grid, [&](const Point& p) {
    const auto step = [](double x) { return 0.5 * (1 + std::erf(x / (0.6 * std::sqrt(2.0)))); };
    const double r = p.norm(), wall = 20 + 40 * covered(p) + 20 * covered(p) * step(r - 21);
    return static_cast<float>(wall + (85 - wall) * step(17 - r) + 25 * step(14 - r) +
                              noise(generator));
  });
  CorticalTissue tissue = tissueFromShares(
      volumeOf(grid, [&](const Point& p) { return shareOf(p, 14, 4); }),
      volumeOf(grid, [&](const Point& p) { return shareOf(p, 17 + 5 * covered(p), 4); }));
  SurfaceOptions options;
  options.faces = 6000;
  const auto errors = [&] {  // mean distance from the border: under the wall, elsewhere
    const auto made = buildSurfaces(tissue, image, options);
    expectSound(made.pial);
    std::array<double, 2> sum = {}, count = {};
    for (Eigen::Index v = 0; v < made.pial.vertexCount(); ++v) {
      const Point p = made.pial.positions.row(v);
      if (covered(p) > 0 && covered(p) < 1) continue;
      const int where = covered(p) > 0 ? 0 : 1;
      sum[where] += std::abs(p.norm() - 17);
      count[where] += 1;
    }
    return std::array{sum[0] / count[0], sum[1] / count[1]};
  };
  const auto found = errors();
  EXPECT_LT(found[0], 0.7);
  EXPECT_LT(found[1], 0.2);
  tissue.byBrightness = false;
  EXPECT_GT(errors()[0], 3);
}

/// Mean over a voxel of what is at its points.
template <class At>
float meanOver(const Grid& grid, const Point& middle, const At& at) {
  constexpr int kPoints = 4;
  double sum = 0;
  for (int n = 0; n < kPoints * kPoints * kPoints; ++n) {
    const Vector part(n % kPoints, n / kPoints % kPoints, n / (kPoints * kPoints));
    const Vector off = (part.array() + 0.5) / kPoints - 0.5;
    sum += at(Point(middle + grid.direction * off.cwiseProduct(grid.spacing)).norm());
  }
  return static_cast<float>(sum / (kPoints * kPoints * kPoints));
}

TEST(CorticalSurface, TheBorderBesideNarrowFluidIsRightOnVoxelsOfAnyShape) {
  // White matter, cortex, fluid, dura and fluid, as voxels of a scanner take their mean.
  constexpr double kInner = 14, kOuter = 17, kFluid = 35, kWhite = 115;
  for (const Vector& spacing : {Vector(0.8, 0.8, 0.8), Vector(1, 1, 2)}) {
    Grid grid = lattice(1, spacing);
    for (int a = 0; a < 3; ++a) grid.size[a] = static_cast<int>(44 / spacing[a]) + 1;
    const Vector last = Vector(grid.size[0], grid.size[1], grid.size[2]) - Vector::Ones();
    grid.origin = -(grid.direction * (0.5 * last.cwiseProduct(spacing)));
    const auto image = volumeOf(grid, [&](const Point& p) {
      return meanOver(grid, p, [&](double r) {
        if (r < kInner) return kWhite;
        if (r < kOuter) return 80.0;
        return r > kOuter + 1 && r < kOuter + 2 ? 70.0 : kFluid;
      });
    });
    const auto within = [&](double border) {
      return volumeOf(grid, [&](const Point& p) {
        return meanOver(grid, p, [&](double r) { return r < border ? 1.0 : 0.0; });
      });
    };
    SurfaceOptions options;
    options.faces = 3000;
    options.fluid = kFluid / kWhite;
    const CorticalTissue tissue = tissueFromShares(within(kInner), within(kOuter));
    const auto made = buildSurfaces(tissue, image, options);
    const double known = (made.pial.positions.rowwise().norm().array() - kOuter).mean();
    options.fluid = 0;
    const auto other = buildSurfaces(tissue, image, options);
    const double unknown = (other.pial.positions.rowwise().norm().array() - kOuter).mean();
    std::printf("voxels %g x %g x %g: %+.3f mm, %+.3f without fluid's brightness\n", spacing[0],
                spacing[1], spacing[2], known, unknown);
    EXPECT_LT(std::abs(known), 0.1) << spacing.transpose();
    EXPECT_LT(unknown, known - 0.02) << spacing.transpose();
    EXPECT_LT(std::abs(made.white.mesh.positions.rowwise().norm().mean() - kInner), 0.1);
  }
}

/// White matter in furrows about the third axis, cortex of 2.5 mm upon it, the banks almost
/// touching: shares and image on voxels of 0.5 mm.
struct Furrows {
  Volume<float> white, tissue, image;
};
Furrows furrows() {
  const Grid grid = lattice(88, Vector::Constant(0.5));
  const auto white = volumeOf(grid, [](const Point& p) -> std::uint8_t {
    return p.norm() < 13 + 2.5 * std::cos(8 * std::acos(p.z() / std::max(p.norm(), 1e-9)));
  });
  const Volume<float> squared = squaredDistanceTo(white);
  Furrows made{Volume<float>(grid), Volume<float>(grid), Volume<float>(grid)};
  for (std::size_t v = 0; v < white.size(); ++v) {
    made.white[v] = white[v];
    made.tissue[v] = squared[v] < 6.25 ? 1 : 0;
    made.image[v] = white[v] != 0 ? 110 : made.tissue[v] != 0 ? 80 : 30;
  }
  return made;
}

/// Means over blocks of voxels.
Volume<float> blocksOf(const Volume<float>& volume, const std::array<int, 3>& block) {
  Grid grid = volume.grid;
  for (int a = 0; a < 3; ++a) {
    grid.size[a] /= block[a];
    grid.spacing[a] *= block[a];
    grid.origin += grid.direction.col(a) * (0.5 * (block[a] - 1) * volume.grid.spacing[a]);
  }
  Volume<float> result(grid, 0);
  const float share = 1.0F / static_cast<float>(block[0] * block[1] * block[2]);
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const auto at = volume.grid.subscripts(v);
    result(at[0] / block[0], at[1] / block[1], at[2] / block[2]) += share * volume[v];
  }
  return result;
}

TEST(CorticalSurface, LongVoxelsDoNotLengthenTrajectoriesInFurrows) {
  const Furrows fine = furrows();
  SurfaceOptions options;
  options.faces = 16000;
  options.fluid = 30.0 / 110;
  // By how much trajectories are longer than the surfaces are apart.
  const auto excessOn = [&](const std::array<int, 3>& block) {
    const auto made =
        buildSurfaces(tissueFromShares(blocksOf(fine.white, block), blocksOf(fine.tissue, block)),
                      blocksOf(fine.image, block), options);
    const double mean = meanThickness(made.columns.area, made.columns.thickness);
    const double nearest = meanThickness(geometry::vertexAreas(made.mid), made.nearestThickness);
    std::printf("voxels of %d x %d x %d half mm: %.3f mm, nearest %.3f mm\n", block[0], block[1],
                block[2], mean, nearest);
    return mean - nearest;
  };
  const double cubes = excessOn({2, 2, 2});
  EXPECT_LT(excessOn({2, 2, 4}), cubes + 0.02);
  EXPECT_LT(excessOn({4, 2, 2}), cubes + 0.02);
}

TEST(CorticalSurface, AMaskThatEndsAtTheCortexIsItsBorder) {
  // A brain that was cut out along its cortex: the image falls a little towards fluid, then to 0;
  // what lies at the edge is partly fluid to a classifier, so that its border lies further in.
  const Grid grid = lattice(54, Vector::Constant(1));
  const auto image =
      volumeOf(grid, [&](const Point& p) { return p.norm() < 17 ? brightness(p, 14, 17) : 0.0F; });
  const auto tissue = [&](float atEdge) {
    return tissueFromShares(volumeOf(grid, [&](const Point& p) { return shareOf(p, 14, 1); }),
                            volumeOf(grid, [&](const Point& p) {
                              return p.norm() < 16 ? 1.0F : (p.norm() < 17 ? atEdge : 0.0F);
                            }));
  };
  SurfaceOptions options;
  options.faces = 6000;
  options.fluid = 20.0 / 110;
  const auto made = buildSurfaces(tissue(0.55F), image, options);
  const auto bounded = buildSurfaces(tissue(1), options);
  const double off = (made.pial.positions.rowwise().norm().array() - 17).mean();
  const double mask = (bounded.pial.positions.rowwise().norm().array() - 17).mean();
  std::printf("pial surface %+.3f mm from the border, the mask's edge %+.3f\n", off, mask);
  EXPECT_NEAR(off, mask, 0.05);
  // The image shows the white border, and of the outer one that it lies within a voxel.
  EXPECT_LT(made.image.doubt.col(0).maxCoeff(), 0.5);
  EXPECT_GT(made.image.doubt.col(1).minCoeff(), 0.2);
  EXPECT_EQ(doubtfulOf(made).sum(), 0);
}

TEST(CorticalSurface, AMaskThatMayHaveCutCortexOffIsDoubt) {
  // Upwards, the brain was cut out within the cortex.
  const Grid grid = lattice(54, Vector::Constant(1));
  const auto isCut = [](const Point& p) { return p.z() > 0.8 * p.norm(); };
  const auto border = [&](const Point& p) { return isCut(p) ? 15.0 : 17.0; };
  const auto image = volumeOf(
      grid, [&](const Point& p) { return p.norm() < border(p) ? brightness(p, 14, 17) : 0.0F; });
  const auto tissue =
      tissueFromShares(volumeOf(grid, [&](const Point& p) { return shareOf(p, 14, 1); }),
                       volumeOf(grid, [&](const Point& p) { return shareOf(p, border(p), 1); }));
  SurfaceOptions options;
  options.faces = 6000;
  options.fluid = 20.0 / 110;
  const auto made = buildSurfaces(tissue, image, options);
  const Eigen::VectorXd doubtful = doubtfulOf(made);
  for (Eigen::Index v = 0; v < doubtful.size(); ++v) {
    const Point p = made.white.mesh.positions.row(v);
    const double height = p.z() / p.norm();
    const bool isNear = height > 0.6 && height < 0.92;  // where the cut begins
    EXPECT_TRUE(isNear || doubtful[v] == (height > 0.75)) << p.transpose();
  }
}

TEST(CorticalSurface, AThinBladeOfWhiteMatterEndsWhereItDoes) {
  // A blade of 2 mm out of a ball of white matter: across it the image shows the other side's
  // cortex, too.
  constexpr double kHalf = 1, kBall = 9, kBlade = 20, kCortex = 3;
  const auto toWhite = [](const Point& p) {
    const double rim = std::max(std::hypot(p.x(), p.y()) - kBlade, 0.0);
    return std::min(p.norm() - kBall, rim > 0
                                          ? std::hypot(rim, std::max(std::abs(p.z()) - kHalf, 0.0))
                                          : std::abs(p.z()) - kHalf);
  };
  const Grid grid = lattice(54, Vector::Constant(1));
  const auto meanOf = [&](const auto& value) {
    return volumeOf(grid, [&](const Point& p) {
      constexpr int kParts = 5;
      double sum = 0;
      for (int n = 0; n < kParts * kParts * kParts; ++n) {
        const Vector part(n % kParts, n / kParts % kParts, n / (kParts * kParts));
        const Vector off = (part.array() + 0.5) / kParts - 0.5;
        sum += value(toWhite(p + grid.axesToWorld(off)));
      }
      return static_cast<float>(sum / (kParts * kParts * kParts));
    });
  };
  const auto image = meanOf([](double d) { return d < 0 ? 110.0 : d < kCortex ? 80.0 : 30.0; });
  const CorticalTissue tissue =
      tissueFromShares(meanOf([](double d) { return d < 0 ? 1.0 : 0.0; }),
                       meanOf([](double d) { return d < kCortex ? 1.0 : 0.0; }));
  SurfaceOptions options;
  options.faces = 12000;
  const auto made = buildSurfaces(tissue, image, options);
  double sum = 0;
  int count = 0;
  for (Eigen::Index v = 0; v < made.white.mesh.vertexCount(); ++v) {
    const Point p = made.white.mesh.positions.row(v);
    const double out = std::hypot(p.x(), p.y());
    if (out < kBall + 2 || out > kBlade - 2) continue;
    sum += std::abs(p.z()) - kHalf;
    ++count;
  }
  std::printf("white surface %+.3f mm from a blade's sides\n", sum / count);
  ASSERT_GT(count, 100);
  EXPECT_LT(std::abs(sum / count), 0.1);
}

TEST(CorticalSurface, AnImageWithoutEdgesLeavesTheLabelsBorders) {
  const auto tissue = shell(14, 17, 1);
  SurfaceOptions options;
  options.faces = 3000;
  const auto plain = buildSurfaces(tissue, options);
  const auto made =
      buildSurfaces(tissue, Volume<float>(lattice(50, Vector::Constant(1)), 100.0F), options);
  EXPECT_EQ(made.image.missingWhite, made.thickness.size());
  EXPECT_EQ(made.image.missingOuter, made.thickness.size());
  EXPECT_EQ(made.white.mesh.positions, plain.white.mesh.positions);
  // The one's inner border is the mesh, the other's the level.
  EXPECT_LT((made.pial.positions - plain.pial.positions).rowwise().norm().maxCoeff(), 0.15);
}

TEST(CorticalSurface, HoldsFoldsApart) {
  SurfaceOptions options;
  options.faces = 12000;
  TissueOptions labels;
  labels.preset = LabelPreset::ThreeClass;
  const auto made = buildSurfaces(tissueFromLabels(foldedLabels(0.8), labels), options);
  for (const TriangleMesh* mesh : {&made.white.mesh, &made.mid, &made.pial}) expectSound(*mesh);
  EXPECT_GT(geometry::enclosedVolume(made.pial), geometry::enclosedVolume(made.mid));
  EXPECT_GT(geometry::enclosedVolume(made.mid), geometry::enclosedVolume(made.white.mesh));
}

/// Grey matter within 2.5 mm of a ball with twelve folds 8 mm deep, on faces of 3.5 mm.
TEST(CorticalSurface, TheMiddleOfACoarseMeshStaysInTheRibbonOfFolds) {
  const Grid grid = lattice(72, Vector::Constant(1));
  const Volume<Label> white = volumeOf(grid, [&](const Point& p) -> Label {
    const double across = std::hypot(p.x(), p.y()), r = p.norm() + 1e-9;
    const double wave = 4 * std::cos(12 * std::atan2(p.y(), p.x())) * across * across / (r * r);
    return r < 22 + wave ? 3 : 0;
  });
  Volume<Label> labels = white;
  for (std::size_t v = 0; v < white.size(); ++v) {
    const auto s = grid.subscripts(v);
    for (int n = 0; n < 125 && white[v] != 0; ++n) {
      const std::array<int, 3> way = {n % 5 - 2, n / 5 % 5 - 2, n / 25 - 2};
      if (Vector(way[0], way[1], way[2]).norm() >= 2.5) continue;
      Label& beside = labels(s[0] + way[0], s[1] + way[1], s[2] + way[2]);
      beside = beside == 0 ? 2 : beside;
    }
  }
  TissueOptions options;
  options.preset = LabelPreset::ThreeClass;
  SurfaceOptions few;
  few.faces = 1500;
  const auto made = buildSurfaces(tissueFromLabels(labels, options), few);
  expectSound(made.mid);
  EXPECT_LT(made.noRibbon, made.mid.vertexCount() / 100);
}

TEST(CorticalSurface, RecoversTheBoundaryOfABuriedSulcus) {
  // Two plates of white matter, 5 mm of grey between them and 3 mm around: where the banks face
  // each other the grey matter is 2.5 mm thick, though labels show no fluid between.
  const Grid grid = lattice(48, Vector::Constant(1));
  const auto labels = volumeOf(grid, [](const Point& p) -> Label {
    const auto plate = [&](double x0, double x1, double grow) {
      return p.x() > x0 - grow && p.x() < x1 + grow && std::abs(p.y()) < 14 + grow &&
             p.z() > -14 - grow && p.z() < 14 + grow;
    };
    const bool base = std::abs(p.x()) < 8 && std::abs(p.y()) < 14 && p.z() > -14 && p.z() < -9;
    if (plate(-8, -2.5, 0) || plate(2.5, 8, 0) || base) return 3;
    return plate(-8, -2.5, 3) || plate(2.5, 8, 3) ? 2 : 0;
  });
  TissueOptions options;
  options.preset = LabelPreset::ThreeClass;
  SurfaceOptions surfaces;
  surfaces.faces = 8000;
  const auto made = buildSurfaces(tissueFromLabels(labels, options), surfaces);
  expectSound(made.white.mesh);
  expectSound(made.pial);
  EXPECT_GT(made.cutLinks, 100);
  double sum = 0;
  int count = 0;
  for (Eigen::Index v = 0; v < made.thickness.size(); ++v) {
    const Point p = made.white.mesh.positions.row(v);
    if (std::abs(p.x()) > 3.2 || std::abs(p.y()) > 9 || std::abs(p.z()) > 6) continue;
    sum += made.thickness[v];
    ++count;
  }
  ASSERT_GT(count, 50);
  EXPECT_NEAR(sum / count, 2.4, 0.2);  // 2.5 less the gap that is kept
}

/// A ball in a thick ribbon, with a thread of white matter out of it, `share` above the level.
CorticalTissue ballWithThread(double share) {
  const Grid grid = lattice(44, Vector::Constant(1));
  const auto white = volumeOf(grid, [&](const Point& p) {
    const Vector s = grid.toIndex(p) - Vector::Constant(22);
    const bool onThread =
        std::abs(s.x()) < 0.4 && std::abs(s.y()) < 0.4 && s.z() > 0 && s.z() < 14.5;
    return std::max(shareOf(p, 12, 1), onThread ? static_cast<float>(0.5 + share) : 0.0F);
  });
  const auto tissue = volumeOf(grid, [&](const Point& p) { return shareOf(p, 16, 1); });
  return tissueFromShares(white, tissue);
}

TEST(CorticalSurface, AThreadFarThinnerThanAVoxelHasNoFacesOfAlmostNothing) {
  SurfaceOptions options;
  options.faces = 6000;
  const CorticalTissue tissue = ballWithThread(0.003);
  const CorticalSurfaces made = buildSurfaces(tissue, options);
  const auto faces = extractWhite(tissue, options).mesh.faceCount();
  const double least = 0.02 * made.white.edgeLength * made.white.edgeLength;
  for (const TriangleMesh* mesh : {&made.white.mesh, &made.mid, &made.pial}) {
    expectSound(*mesh);
    EXPECT_EQ(mesh->faceCount(), faces);
    const Evenness evenness = evennessOf(*mesh);
    EXPECT_GE(evenness.leastFace, least);
    EXPECT_LE(evenness.longestEdge, 3.1 * made.white.edgeLength);
  }
  EXPECT_EQ(made.thickness.size(), made.pial.vertexCount());
}

TEST(CorticalSurface, BanksBesideAFilmOfFluidKeepAGap) {
  // Two plates of white matter on a base; between their banks a voxel of almost no fluid.
  const Grid grid = lattice(44, Vector::Constant(1));
  const auto within = [&](const Point& p, double grow) {
    const Vector s = grid.toIndex(p) - Vector::Constant(21);
    const double x = std::abs(s.x()), sides = std::min(12 - std::abs(s.y()), 12 - std::abs(s.z()));
    const double plate = std::min({9 - x, x - 4, sides}),
                 base = std::min({9 - x, -9 - s.z(), sides});
    return static_cast<float>(std::clamp(0.5 + std::max(plate, base) + grow, 0.0, 1.0));
  };
  const auto white = volumeOf(grid, [&](const Point& p) { return within(p, 0); });
  const auto tissue = volumeOf(grid, [&](const Point& p) {
    const Vector s = grid.toIndex(p) - Vector::Constant(21);
    const bool film = std::abs(s.x()) < 0.5 && s.z() > -4 && within(p, 4.5) > 0.5F;
    return film ? 0.495F : within(p, 4.5);
  });
  SurfaceOptions options;
  options.faces = 12000;
  const CorticalSurfaces made = buildSurfaces(tissueFromShares(white, tissue), options);
  expectSound(made.pial);
  EXPECT_GE(nearestToItself(made.pial, 0.1), 0.05 * std::min(1.0, made.white.edgeLength));
}

TEST(CorticalSurface, DoesNotDependOnThreads) {
  SurfaceOptions options;
  options.faces = 3000;
  const auto tissue = shell(9, 11.5, 1);
  setThreadCount(1);
  const auto one = buildSurfaces(tissue, options);
  setThreadCount(3);
  const auto three = buildSurfaces(tissue, options);
  setThreadCount(0);
  EXPECT_EQ(one.pial.positions, three.pial.positions);
  EXPECT_EQ(one.thickness, three.thickness);
}

TEST(CorticalTissue, WhiteMatterIsBareByArea) {
  // A brick of 8 x 8 x 4 mm in voxels of 1 x 1 x 2 mm, with grey matter on its top and one side and
  // a cut beneath: three sides of four are bare.
  constexpr Label kGrey = 2, kWhite = 3, kCut = 4;
  Volume<Label> labels(lattice(16, Vector(1, 1, 2)), 0);
  for (int j = 4; j < 12; ++j) {
    for (int i = 4; i < 12; ++i) {
      labels(i, j, 5) = kCut;
      labels(i, j, 6) = labels(i, j, 7) = kWhite;
      labels(i, j, 8) = kGrey;
      labels(12, j, 6) = labels(12, j, 7) = kGrey;
    }
  }
  TissueOptions options;
  options.preset = LabelPreset::ThreeClass;
  EXPECT_NEAR(bareShare(tissueFromLabels(labels, options)), 3 * 32.0 / (4 * 32 + 64), 1e-12);
}

TEST(CorticalTissue, NamesWhatIsWrong) {
  const Grid grid = lattice(30, Vector::Constant(1));
  const auto ball = volumeOf(
      grid, [](const Point& p) -> Label { return p.norm() < 8 ? 2 : (p.norm() < 10 ? 3 : 0); });
  TissueOptions options;
  options.white = {7};
  EXPECT_THROW((void)tissueFromLabels(ball, options), InvalidInput);
  options.white = {2};
  options.grey = {2};
  EXPECT_THROW((void)tissueFromLabels(ball, options), InvalidInput);
  options.grey = {3};
  EXPECT_EQ(tissueFromLabels(ball, options).structure, "Cortex");
  const auto cut = volumeOf(grid, [](const Point&) -> Label { return 2; });
  options.grey.clear();
  EXPECT_THROW((void)tissueFromLabels(cut, options), InvalidInput);
  options.closeEdges = true;
  EXPECT_GT(tissueFromLabels(cut, options).whiteVoxels, 0);
}

TEST(CorticalTissue, ParcelsOfFreeSurferAreTheirTissue) {
  // A ball of white matter with a ventricle in cortex, plain and in parcels.
  struct Case {
    Label white, otherWhite, grey, otherGrey;
    Side side;
  };
  const Grid grid = lattice(40, Vector::Constant(1));
  std::optional<CorticalTissue> plain;
  for (const Case& c :
       {Case{2, 2, 3, 3, Side::Left}, Case{2, 2, 1005, 1022, Side::Left},
        Case{3005, 5001, 1005, 1022, Side::Left}, Case{2, 2, 11101, 11175, Side::Left},
        Case{41, 41, 2005, 2022, Side::Right}, Case{41, 4007, 12110, 42, Side::Right}}) {
    const Label ventricle = c.side == Side::Left ? 4 : 43;
    const auto labels = volumeOf(grid, [&](const Point& p) -> Label {
      const double r = p.norm();
      if (r < 4) return ventricle;
      if (r < 12) return p.x() < 0 ? c.white : c.otherWhite;
      return r < 15 ? (p.y() < 0 ? c.grey : c.otherGrey) : 0;
    });
    const CorticalTissue tissue = tissueFromLabels(labels);
    EXPECT_EQ(tissue.preset, LabelPreset::Aseg);
    EXPECT_EQ(tissue.structure, c.side == Side::Left ? "CortexLeft" : "CortexRight");
    if (!plain) plain = tissue;
    EXPECT_EQ(tissue.greyVoxels, plain->greyVoxels);
    EXPECT_EQ(tissue.filledVoxels, plain->filledVoxels);
    EXPECT_EQ(tissue.white.data, plain->white.data);
  }
}

TEST(CorticalTissue, CutsTwoHemispheresAtTheirBridge) {
  // Two balls joined by a bar, the left with a bulge over the plane that the bar does not hold.
  const Grid grid = lattice(80, Vector::Constant(1));
  const auto white = volumeOf(grid, [](const Point& p) -> std::uint8_t {
    const bool left = (p - Point(-19, 0, 0)).norm() < 16, right = (p - Point(19, 0, 0)).norm() < 16;
    const bool bar = std::abs(p.x()) < 10 && std::hypot(p.y(), p.z()) < 3;
    const bool bulge = p.x() > -12 && p.x() < 1.5 && std::hypot(p.y() - 9, p.z()) < 2.5;
    return left || right || bar || bulge ? 1 : 0;
  });
  const auto sides = splitHemispheres(white);
  for (std::size_t v = 0; v < sides.size(); ++v) {
    if (!white[v]) continue;
    const auto s = grid.subscripts(v);
    const Point p = grid.toWorld(Vector(s[0], s[1], s[2]));
    const bool bulge = p.x() < 1.5 && p.y() > 6;
    if (bulge || p.x() < -3) {
      EXPECT_EQ(sides[v], 1) << p.transpose();
    }
    if (!bulge && p.x() > 3) {
      EXPECT_EQ(sides[v], 2) << p.transpose();
    }
  }
}

}  // namespace
}  // namespace explica::surface
