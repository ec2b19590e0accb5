// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <Eigen/SparseCore>

namespace explica::geometry {

/// (b - a) x (c - a) of each face, F x 3, mm^2: outward, twice the area long.
[[nodiscard]] Positions faceNormalVectors(const TriangleMesh& mesh);
[[nodiscard]] Eigen::VectorXd faceAreas(const TriangleMesh& mesh);
[[nodiscard]] double totalArea(const TriangleMesh& mesh);

/// Signed volume enclosed by a closed mesh, mm^3; positive if faces are counter-clockwise from
/// outside.
[[nodiscard]] double enclosedVolume(const TriangleMesh& mesh);

/// Turns all faces over where the mesh's volume is negative, and says whether it did.
bool turnOutward(TriangleMesh& mesh);

/// A third of the areas of the faces at each vertex, mm^2.
[[nodiscard]] Eigen::VectorXd vertexAreas(const TriangleMesh& mesh);

/// Area-weighted outward unit normals at vertices, V x 3; zero at vertices of no face.
[[nodiscard]] Positions vertexNormals(const TriangleMesh& mesh);

/// Cotangent Laplacian, V x V, symmetric positive semi-definite, without the mass:
/// x^T L x = integral of |grad x|^2 for x linear on faces.
[[nodiscard]] Eigen::SparseMatrix<double> cotangentLaplacian(const TriangleMesh& mesh);

/// Mean length of the mesh's edges, each counted once per face, mm.
[[nodiscard]] double meanEdgeLength(const TriangleMesh& mesh);

/// Smallest interior angle of each face, radians.
[[nodiscard]] Eigen::VectorXd smallestAnglesRad(const TriangleMesh& mesh);

}  // namespace explica::geometry
