// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The flat parameterisations that the benchmark compares with must themselves be right.

#include "../benchmark/FlatMaps.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Unfolding/Distortion.h"

#include <gtest/gtest.h>

#include <numeric>

namespace explica::unfolding {
namespace {

Distortion distortionOf(const TriangleMesh& mesh, const Positions& flat) {
  std::vector<std::int32_t> faces(static_cast<std::size_t>(mesh.faceCount()));
  std::iota(faces.begin(), faces.end(), 0);
  return measureDistortion(mesh, flat, faces);
}

/// A sheet rolled about a cylinder: its flat map is exact but for the chords.
TriangleMesh makeRolled() {
  TriangleMesh mesh = geometry::makeRectangle(40, 20, 40, 20);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const double angle = mesh.positions(v, 0) / 15;
    mesh.positions(v, 0) = 15 * std::sin(angle);
    mesh.positions(v, 2) = 15 * (1 - std::cos(angle));
  }
  return mesh;
}

TEST(FlatMaps, OfARolledSheetAreIsometric) {
  const TriangleMesh mesh = makeRolled();
  for (const Positions& flat : {leastSquaresConformalMap(mesh), asRigidAsPossibleMap(mesh)}) {
    const Distortion d = distortionOf(mesh, flat);
    EXPECT_LT(d.edgeStrainMean, 1e-6);
    EXPECT_LT(d.angleErrorMeanRad, 1e-6);
    EXPECT_EQ(flippedFaces(flat, mesh.faces), 0u);
    EXPECT_EQ(flat.col(2).cwiseAbs().maxCoeff(), 0);
  }
}

TEST(FlatMaps, OfACapKeepAnglesOrBalanceBoth) {
  // Stereographic projection is conformal: a cap of 60 degrees grows outward by up to 1/cos^2(30).
  TriangleMesh cap = geometry::makeIcosphere(4, 10.0);
  std::vector<std::int32_t> faces;
  for (Eigen::Index f = 0; f < cap.faceCount(); ++f) {
    bool within = true;
    for (int k = 0; k < 3; ++k) within = within && cap.corner(f, k).z() > 5;
    if (within) faces.push_back(static_cast<std::int32_t>(f));
  }
  const TriangleMesh mesh = geometry::extractFaces(cap, faces).mesh;
  const Distortion conformal = distortionOf(mesh, leastSquaresConformalMap(mesh));
  const Distortion rigid = distortionOf(mesh, asRigidAsPossibleMap(mesh));
  EXPECT_LT(conformal.angleErrorMeanRad, 0.015);  // edges of 0.07 radii: of that size squared
  const double spread = conformal.areaRatio.maxCoeff() / conformal.areaRatio.minCoeff();
  EXPECT_NEAR(spread, std::pow(std::cos(kPi / 6), -4), 0.1);
  EXPECT_LT(rigid.areaErrorMean, conformal.areaErrorMean / 2);
  EXPECT_LT(rigid.edgeStrainMean, conformal.edgeStrainMean);
}

}  // namespace
}  // namespace explica::unfolding
