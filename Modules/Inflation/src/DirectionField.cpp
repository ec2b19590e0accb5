// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Inflation/DirectionField.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"

namespace explica::inflation {

DirectionField::DirectionField(const TriangleMesh& mesh, double reach)
    : faces_(mesh.faces), areas_(geometry::faceAreas(mesh)) {
  if (!(reach > 0)) throw InvalidInput("reach of directions: must be positive");
  Eigen::SparseMatrix<double> matrix = reach * reach * geometry::cotangentLaplacian(mesh);
  const Eigen::VectorXd mass = geometry::vertexAreas(mesh);
  for (Eigen::Index v = 0; v < mass.size(); ++v) {
    matrix.coeffRef(v, v) += mass[v] > 0 ? mass[v] : 1;  // a vertex of no face keeps 0
  }
  solver_.compute(matrix);
  if (!solver_.isDefinite()) {
    throw InvalidInput("surface: its faces are too thin to spread directions over");
  }
}

Positions DirectionField::spread(const Positions& directions) const {
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(solver_.rows(), 3);
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    for (int k = 0; k < 3; ++k) right.row(faces_(f, k)) += areas_[f] / 3 * directions.row(f);
  }
  const Eigen::MatrixXd field = solver_.solve(right);
  Positions result(faces_.rows(), 3);
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    const Eigen::RowVector3d mean =
        (field.row(faces_(f, 0)) + field.row(faces_(f, 1)) + field.row(faces_(f, 2))) / 3;
    const double length = mean.norm();
    result.row(f) = length > 0 ? Eigen::RowVector3d(mean / length) : Eigen::RowVector3d::Zero();
  }
  return result;
}

}  // namespace explica::inflation
