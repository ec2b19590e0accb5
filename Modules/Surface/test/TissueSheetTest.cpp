// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Surface/TissueSheet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace explica::surface {
namespace {

enum : Label { kOutside = 0, kWhite = 3, kGrey = 2 };

/// Labels of a block of n^3 voxels; places in voxels from the block's middle.
Volume<Label> blockOf(int n, double spacing, const std::function<Label(const Vector&)>& label) {
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing = Vector::Constant(spacing);
  grid.direction << std::cos(0.3), -std::sin(0.3), 0, std::sin(0.3), std::cos(0.3), 0, 0, 0, 1;
  grid.origin = Point(5, -40, 12);
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    labels[v] = label(Vector(s[0], s[1], s[2]) - Vector::Constant(0.5 * (n - 1)));
  }
  return labels;
}

/// A shell of 5 voxels about a point near one face of the block, which cuts it.
Label cutShell(const Vector& p) {
  const double r = (p - Vector(0, 0, -14)).norm();
  return r < 9 ? kWhite : (r < 14 ? kGrey : kOutside);
}

TissueMasks masksOf(const Volume<Label>& labels) {
  TissueOptions options;
  options.white = {kWhite};
  options.grey = {kGrey};
  return masksFromLabels(labels, options);
}

CorticalSurfaces sheetsOf(const Volume<Label>& labels, int faces) {
  SurfaceOptions options;
  options.faces = faces;
  return buildSheets(masksOf(labels), options);
}

void expectSound(const CorticalSurfaces& made, std::int64_t euler, std::int64_t rims) {
  EXPECT_TRUE(made.sheet.open);
  EXPECT_EQ(made.sheet.rims, rims);
  for (const TriangleMesh* mesh : {&made.white.mesh, &made.mid, &made.pial}) {
    const auto condition = geometry::inspectMesh(*mesh);
    EXPECT_TRUE(condition.manifold());
    EXPECT_EQ(condition.components, 1);
    EXPECT_EQ(condition.eulerCharacteristic, euler);
    EXPECT_EQ(condition.zeroAreaFaces, 0);
    EXPECT_TRUE(geometry::findSelfIntersections(*mesh).empty());
    EXPECT_EQ(mesh->faces, made.mid.faces);
  }
}

}  // namespace

TEST(TissueSheet, OfACutShellIsACapWhoseThicknessHoldsWhereItIsKnown) {
  const Volume<Label> labels = blockOf(40, 1, cutShell);
  EXPECT_TRUE(runsOutOfImage(masksOf(labels)));
  const CorticalSurfaces made = sheetsOf(labels, 4000);
  expectSound(made, 1, 1);
  EXPECT_NEAR(static_cast<double>(made.mid.faceCount()), 4000, 20);
  EXPECT_GT(made.sheet.cutByImage, 100);
  const Point centre = labels.grid.toWorld(Vector(19.5, 19.5, 5.5));
  double sum = 0;
  int known = 0;
  for (Eigen::Index v = 0; v < made.thickness.size(); ++v) {
    if (!made.sheet.known[v]) continue;
    ++known;
    sum += made.thickness[v];
    EXPECT_NEAR(made.thickness[v], 5, 0.3);
    const auto radius = [&](const TriangleMesh& mesh) {
      return (mesh.positions.row(v).transpose() - centre).norm();
    };
    EXPECT_NEAR(radius(made.white.mesh), 9, 0.3);
    EXPECT_NEAR(radius(made.mid), 11.5, 0.3);
    EXPECT_NEAR(radius(made.pial), 14, 0.3);
  }
  EXPECT_GT(known, 500);
  EXPECT_NEAR(sum / known, 5, 0.05);
}

TEST(TissueSheet, HasTheTopologyOfTheTissue) {
  // A wall between two faces of the block with a hole through it: an annulus with two rims.
  const Volume<Label> labels = blockOf(36, 1, [](const Vector& p) -> Label {
    if (std::hypot(p.y(), p.z()) < 7) return kOutside;
    return p.x() < -3 ? kWhite : (p.x() < 1 ? kGrey : kOutside);
  });
  SurfaceOptions options;
  options.faces = 3000;
  TissueMasks masks = masksOf(labels);
  // The hole is a cut: neither inside nor outside.
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = labels.grid.subscripts(v);
    if (std::hypot(s[1] - 17.5, s[2] - 17.5) < 7) masks.insulated[v] = 1;
  }
  expectSound(buildSheets(masks, options), 0, 2);
}

TEST(TissueSheet, ClosesPocketsAndSpecksInTheTissue) {
  const Volume<Label> labels = blockOf(36, 1, [](const Vector& p) -> Label {
    if ((p - Vector(-1.5, 0.5, 0.5)).norm() < 1.6) return kOutside;  // a vessel
    if ((p - Vector(-0.5, 10.5, 3.5)).norm() < 1.2) return kWhite;   // a speck
    return p.x() < -5 ? kWhite : (p.x() < 3 ? kGrey : kOutside);
  });
  const CorticalSurfaces made = sheetsOf(labels, 3000);
  expectSound(made, 1, 1);
  EXPECT_EQ(made.sheet.pocketsFilled, 2);
  for (Eigen::Index v = 0; v < made.thickness.size(); ++v) {
    EXPECT_NEAR(made.thickness[v], 8, 0.15);
  }
}

TEST(TissueSheet, BanksOfAClosedSulcusReachItsMiddle) {
  // A groove as wide as twice the cortex, aslant to the grid, that nothing but grey matter fills.
  const auto groove = [](const Vector& p) -> Label {
    const double across = (p.x() + 0.3 * p.y() + 0.2 * p.z()) / std::sqrt(1.13);
    if (p.y() > 11) return kOutside;
    return p.y() > 7 || (std::abs(across) < 4 && p.y() > -9) ? kGrey : kWhite;
  };
  const CorticalSurfaces made = sheetsOf(blockOf(44, 1, groove), 8000);
  expectSound(made, 1, 1);
  EXPECT_GT(made.cutLinks, 500);
  EXPECT_LT(static_cast<double>(made.heldBackPial),
            0.025 * static_cast<double>(made.mid.vertexCount()));
}

TEST(TissueSheet, ScalesWithTheUnitOfLength) {
  const CorticalSurfaces one = sheetsOf(blockOf(40, 1, cutShell), 2000);
  Volume<Label> labels = blockOf(40, 1, cutShell);
  labels.grid.spacing *= 0.25;
  labels.grid.origin *= 0.25;
  const CorticalSurfaces quarter = sheetsOf(labels, 2000);
  ASSERT_EQ(one.mid.vertexCount(), quarter.mid.vertexCount());
  EXPECT_TRUE((one.pial.positions.array() == 4 * quarter.pial.positions.array()).all());
}

TEST(TissueSheet, RefusesWhatHoldsNone) {
  EXPECT_THROW((void)sheetsOf(blockOf(12, 1, [](const Vector&) -> Label { return kGrey; }), 200),
               InvalidInput);
  TissueMasks masks = masksOf(blockOf(20, 1, cutShell));
  masks.greyVoxels = 0;
  EXPECT_THROW((void)buildSheets(masks), InvalidInput);
}

}  // namespace explica::surface
