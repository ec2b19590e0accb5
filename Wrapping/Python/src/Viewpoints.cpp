// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Viewpoints.h"

#include "Arrays.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <optional>

namespace explica::python {
namespace {

using visibility::Viewpoints;

Positions pointsOf(const Viewpoints& viewpoints) {
  Positions points(static_cast<Eigen::Index>(viewpoints.points.size()), 3);
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    points.row(n) = viewpoints.points[n].transpose();
  }
  return points;
}

Viewpoints viewpointsOf(const py::array_t<double, py::array::c_style | py::array::forcecast>& given,
                        const std::optional<std::vector<double>>& weights) {
  const bool single = given.ndim() == 1 && given.shape(0) == 3;
  if (!single && !(given.ndim() == 2 && given.shape(1) == 3 && given.shape(0) > 0)) {
    throw InvalidInput("viewpoints: one point of three coordinates or an array (N, 3) is needed");
  }
  const py::ssize_t count = given.size() / 3;
  std::vector<Point> points;
  for (py::ssize_t n = 0; n < count; ++n) {
    const double* p = given.data() + 3 * n;
    points.emplace_back(p[0], p[1], p[2]);
  }
  if (weights && weights->empty())
    throw InvalidInput("weights: one positive number a viewpoint is needed");
  return visibility::viewpoints(points, weights.value_or(std::vector<double>{}));
}

}  // namespace

void bindViewpoints(py::module_& m) {
  using namespace py::literals;
  py::class_<Viewpoints>(m, "Viewpoints",
                         "From where a surface is looked at: points with weights that sum to 1.\n\n"
                         "Functions that take viewpoints take a point (3,) or an array (N, 3) of "
                         "equal weights as well.")
      .def(py::init(&viewpointsOf), "points"_a, "weights"_a = py::none(),
           "points (3,) or (N, 3), RAS mm; weights (N,), positive, divided by their sum.")
      .def_property_readonly("points", &pointsOf, "(N, 3), RAS mm.")
      .def_property_readonly(
          "weights",
          [](const Viewpoints& v) -> Eigen::VectorXd {
            return Eigen::Map<const Eigen::VectorXd>(v.weights.data(),
                                                     static_cast<Eigen::Index>(v.weights.size()));
          },
          "(N,), positive, sum 1.")
      .def("__len__", [](const Viewpoints& v) { return v.points.size(); });
  py::implicitly_convertible<py::array, Viewpoints>();
  py::implicitly_convertible<py::sequence, Viewpoints>();

  m.def("view_line", &visibility::viewLine, "start"_a, "end"_a, "count"_a = 8,
        "Viewpoints on the segment from start to end (3,), RAS mm: Gauss-Legendre, exact for\n"
        "integrands of degree 2 * count - 1.");
}

}  // namespace explica::python
