// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"

#include "Explica/Core/Errors.h"

#include <cmath>
#include <limits>
#include <string>

namespace explica::python {

Grid gridOf(const py::array& values, const Eigen::Matrix4d& affine) {
  if (values.ndim() != 2 && values.ndim() != 3) {
    throw InvalidInput("array: has " + std::to_string(values.ndim()) +
                       " axes; an image of 2 or 3 axes is needed");
  }
  std::array<int, 3> size = {1, 1, 1};
  for (py::ssize_t axis = 0; axis < values.ndim(); ++axis) {
    size[axis] = static_cast<int>(values.shape(axis));
  }
  return gridFromAffine(size, affine);
}

Volume<Label> labelVolume(const py::array& values, const Eigen::Matrix4d& affine) {
  Volume<Label> volume;
  volume.grid = gridOf(values, affine);
  const char kind = values.dtype().kind();
  const bool fits = kind == 'b' || (kind == 'i' && values.itemsize() <= 4) ||
                    (kind == 'u' && values.itemsize() < 4);
  if (!fits) {
    constexpr double kMost = std::numeric_limits<Label>::max();
    const auto scalars = py::array_t<double, py::array::f_style | py::array::forcecast>(values);
    for (py::ssize_t n = 0; n < scalars.size(); ++n) {
      const double value = scalars.data()[n];
      if (value != std::rint(value) || std::abs(value) > kMost) {
        throw InvalidInput("labels: value " + std::to_string(value) +
                           " is not a whole number of 32 bits; pass a segmentation, not "
                           "probabilities");
      }
    }
  }
  const auto labels = py::array_t<Label, py::array::f_style | py::array::forcecast>(values);
  volume.data.assign(labels.data(), labels.data() + labels.size());
  return volume;
}

Volume<float> scalarVolume(const py::array& values, const Eigen::Matrix4d& affine) {
  Volume<float> volume;
  volume.grid = gridOf(values, affine);
  const auto scalars = py::array_t<float, py::array::f_style | py::array::forcecast>(values);
  volume.data.assign(scalars.data(), scalars.data() + scalars.size());
  return volume;
}

TriangleMesh meshOf(const Eigen::Ref<const Positions>& positions,
                    const Eigen::Ref<const Faces>& faces) {
  if (faces.size() > 0 && (faces.minCoeff() < 0 || faces.maxCoeff() >= positions.rows())) {
    throw InvalidInput("faces: name vertices " + std::to_string(faces.minCoeff()) + " to " +
                       std::to_string(faces.maxCoeff()) + ", but there are " +
                       std::to_string(positions.rows()) + " vertices, counted from 0");
  }
  return {positions, faces};
}

void requireFaces(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                  const char* argument) {
  for (const std::int32_t f : faces) {
    if (f < 0 || f >= mesh.faceCount()) {
      throw InvalidInput(std::string(argument) + ": face " + std::to_string(f) +
                         " is not one of 0.." + std::to_string(mesh.faceCount() - 1));
    }
  }
}

}  // namespace explica::python
