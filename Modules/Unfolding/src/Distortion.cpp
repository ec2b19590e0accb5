// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Distortion.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::unfolding {
namespace {

std::array<double, 3> anglesOf(const TriangleMesh& mesh, Eigen::Index face) {
  std::array<double, 3> angles;
  for (int k = 0; k < 3; ++k) {
    const Vector u = mesh.corner(face, (k + 1) % 3) - mesh.corner(face, k);
    const Vector v = mesh.corner(face, (k + 2) % 3) - mesh.corner(face, k);
    angles[k] = std::atan2(u.cross(v).norm(), u.dot(v));
  }
  return angles;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return kNaN;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

Distortion measureDistortion(const TriangleMesh& reference, const Positions& deformed,
                             std::span<const std::int32_t> faces) {
  if (deformed.rows() != reference.vertexCount()) {
    throw InvalidInput("deformed: " + std::to_string(deformed.rows()) + " positions for " +
                       std::to_string(reference.vertexCount()) + " vertices");
  }
  if (faces.empty()) throw InvalidInput("faces: none to compare");
  const TriangleMesh before = geometry::extractFaces(reference, faces).mesh;
  const TriangleMesh after = geometry::extractFaces({deformed, reference.faces}, faces).mesh;

  Distortion d;
  const Eigen::Index count = before.faceCount();
  const Eigen::VectorXd areas0 = geometry::faceAreas(before), areas1 = geometry::faceAreas(after);
  d.areaRatio = Eigen::VectorXd::Ones(count);
  d.angleErrorRad.resize(count);
  for (Eigen::Index f = 0; f < count; ++f) {
    if (areas0[f] > 0) d.areaRatio[f] = areas1[f] / areas0[f];
    const auto a0 = anglesOf(before, f), a1 = anglesOf(after, f);
    d.angleErrorRad[f] =
        std::max({std::abs(a1[0] - a0[0]), std::abs(a1[1] - a0[1]), std::abs(a1[2] - a0[2])});
  }
  const Eigen::ArrayXd areaError = (d.areaRatio.array() - 1).abs();
  d.areaErrorMean = areaError.mean();
  d.areaErrorMax = areaError.maxCoeff();
  d.angleErrorMeanRad = d.angleErrorRad.mean();

  const Edges edges = geometry::buildTopology(before.faces, before.vertexCount()).edges;
  d.edgeStrain = Eigen::VectorXd::Zero(edges.rows());
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    const auto length = [&](const TriangleMesh& mesh) {
      return (mesh.positions.row(edges(e, 0)) - mesh.positions.row(edges(e, 1))).norm();
    };
    if (length(before) > 0) d.edgeStrain[e] = std::abs(length(after) / length(before) - 1);
  }
  d.edgeStrainMean = d.edgeStrain.mean();
  d.edgeStrainP95 = percentile({d.edgeStrain.begin(), d.edgeStrain.end()}, 0.95);
  return d;
}

}  // namespace explica::unfolding
