// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <utility>
#include <vector>

namespace explica::python {

namespace py = pybind11;

using PositionsIn = Eigen::Ref<const Positions>;
using FacesIn = Eigen::Ref<const Faces>;

/// Grid of an array's shape, (I, J), (I, J, 1) or (I, J, K), and its 4 x 4 index-to-RAS affine.
[[nodiscard]] Grid gridOf(const py::array& values, const Eigen::Matrix4d& affine);

/// Labels of an integer array; a floating-point one is taken if every value is whole.
/// @throws InvalidInput  names the argument and the first value that is not whole
[[nodiscard]] Volume<Label> labelVolume(const py::array& values, const Eigen::Matrix4d& affine);

/// Scalars of any numeric array, as float32.
[[nodiscard]] Volume<float> scalarVolume(const py::array& values, const Eigen::Matrix4d& affine);

/// Array of shape (I, J, K) over the volume's own memory, which moves into it; first axis fastest,
/// as nibabel keeps images.
template <class T>
[[nodiscard]] py::array arrayOf(Volume<T>&& volume) {
  const auto [i, j, k] = volume.grid.size;
  auto* kept = new std::vector<T>(std::move(volume.data));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  const py::ssize_t s = sizeof(T);
  return py::array_t<T>({i, j, k}, {s, s * i, s * i * j}, kept->data(), owner);
}

/// Array of shape (I, J, K, 3) of a map of points; the volume's memory moves into it.
template <class Scalar>
[[nodiscard]] py::array arrayOf(Volume<Eigen::Matrix<Scalar, 3, 1>>&& volume) {
  const auto [i, j, k] = volume.grid.size;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  auto* kept = new std::vector<Vector3>(std::move(volume.data));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Vector3>*>(p); });
  const py::ssize_t s = sizeof(Scalar);
  return py::array_t<Scalar>({i, j, k, 3}, {3 * s, 3 * s * i, 3 * s * i * j, s},
                             kept->front().data(), owner);
}

/// Array (rows.size(), N) of rows.
template <class T, std::size_t N>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, static_cast<int>(N), Eigen::RowMajor> rowsOf(
    const std::vector<std::array<T, N>>& rows) {
  Eigen::Matrix<T, Eigen::Dynamic, static_cast<int>(N), Eigen::RowMajor> matrix(
      static_cast<Eigen::Index>(rows.size()), static_cast<int>(N));
  for (Eigen::Index n = 0; n < matrix.rows(); ++n) {
    matrix.row(n) = Eigen::Map<const Eigen::Matrix<T, 1, static_cast<int>(N)>>(rows[n].data());
  }
  return matrix;
}

/// The numbers of a list as an array (N,).
template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> columnOf(const std::vector<T>& values) {
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(
      values.data(), static_cast<Eigen::Index>(values.size()));
}

/// A mesh of vertex positions (V, 3), RAS mm, and faces (F, 3).
/// @throws InvalidInput  a face names a vertex that does not exist
[[nodiscard]] TriangleMesh meshOf(const Eigen::Ref<const Positions>& positions,
                                  const Eigen::Ref<const Faces>& faces);

/// @throws InvalidInput  an index that names no face: names the argument
void requireFaces(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                  const char* argument);

}  // namespace explica::python
