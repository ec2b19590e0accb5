// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Core/Errors.h"
#include "Explica/Shapes/AnnulusBoundaries.h"
#include "Explica/Shapes/ShapeFit.h"
#include "Explica/Shapes/ShapeLevel.h"

namespace explica::python {
namespace {

using namespace py::literals;
using shapes::HarmonicAnnulus;
using shapes::HarmonicShape;

void requireCoefficients(const HarmonicAnnulus& annulus, const Eigen::VectorXd& inner,
                         const Eigen::VectorXd& outer) {
  if (inner.size() == annulus.perBoundary() && outer.size() == inner.size()) return;
  throw InvalidInput("inner and outer: " + std::to_string(annulus.perBoundary()) +
                     " coefficients each are needed for order " + std::to_string(annulus.order));
}

HarmonicShape shapeOf(int dimension, const Point& centre, double innerRadius, double outerRadius,
                      const Eigen::VectorXd& inner, const Eigen::VectorXd& outer, int order) {
  HarmonicShape shape{{dimension, centre, innerRadius, outerRadius, order}, inner, outer};
  shapes::requireUsable(shape.annulus);
  requireCoefficients(shape.annulus, inner, outer);
  return shape;
}

/// Points (P, 3); points of the plane get z = 0.
Positions pointsOf(const HarmonicShape& shape,
                   const Eigen::Ref<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>& given) {
  if (given.cols() == 3) return given;
  if (given.cols() != 2 || shape.annulus.dimension != 2) {
    throw InvalidInput("points: an array (P, 3) is needed, or (P, 2) for a shape in the plane");
  }
  Positions points = Positions::Zero(given.rows(), 3);
  points.leftCols<2>() = given;
  return points;
}

void requireVoxels(int voxels) {
  if (voxels < 16) throw InvalidInput("voxels: at least 16 a side are needed");
}

py::dict fitDict(shapes::ShapeFit fit) {
  py::list history;
  for (const auto& i : fit.history) {
    history.append(py::dict("symmetric_difference"_a = i.symmetricDifference,
                            "distance_mean"_a = i.distanceMean, "distance_max"_a = i.distanceMax));
  }
  return py::dict("shape"_a = std::move(fit.shape), "history"_a = history,
                  "path"_a = std::move(fit.path),
                  "termination"_a = std::string(nameOf(fit.termination)));
}

/// Every option of an annulus around targets, and at how many points those are taken.
struct AroundOptions {
  shapes::AnnulusOptions annulus;
  shapes::ShapeFitOptions fit;
};

template <class Visitor>
void describe(AroundOptions& o, Visitor&& visit) {
  describe(o.annulus, visit);
  describe(o.fit, [&](const Field& field, auto& value) {
    if (field.name == "samples") visit(field, value);
  });
}

/// A target: a polygon (V, 2), or positions (V, 3) and faces (F, 3).
struct Target {
  int dimension = 3;
  shapes::TargetSamples samples;
};

Target targetOf(const py::object& target, int samples) {
  if (samples < 16) throw InvalidInput("samples: at least 16 are needed");
  if (py::isinstance<py::tuple>(target)) {
    const auto [positions, faces] = target.cast<std::pair<Positions, Faces>>();
    return {3, shapes::samplesOf(meshOf(positions, faces), samples)};
  }
  const planar::Curve curve{target.cast<Positions2>(), true};
  planar::requireUsable(curve);
  return {2, shapes::samplesOf(curve, samples)};
}

void bindShape(py::module_& m) {
  py::class_<HarmonicShape>(
      m, "Shape",
      "A closed curve or surface as the 1/2 level of a harmonic function u between two concentric\n"
      "circles or spheres, or between two polygons, by the coefficients of u on both.")
      .def(
          py::init(&shapeOf), "dimension"_a, "centre"_a, "inner_radius"_a, "outer_radius"_a,
          "inner"_a, "outer"_a, "order"_a,
          "dimension 2 or 3; centre (3,) and radii, mm; coefficients inner and outer, 2 order + 1\n"
          "each in the plane, (order + 1)^2 in space.")
      .def_property_readonly("dimension",
                             [](const HarmonicShape& s) { return s.annulus.dimension; })
      .def_property_readonly(
          "centre", [](const HarmonicShape& s) { return s.annulus.centre; }, "(3,), mm.")
      .def_property_readonly(
          "inner_radius", [](const HarmonicShape& s) { return s.annulus.innerRadius; }, "mm.")
      .def_property_readonly(
          "outer_radius", [](const HarmonicShape& s) { return s.annulus.outerRadius; }, "mm.")
      .def_property_readonly(
          "order", [](const HarmonicShape& s) { return s.annulus.order; },
          "Highest angular frequency.")
      .def_property_readonly(
          "inner", [](const HarmonicShape& s) { return s.inner; },
          "Coefficients of u on the inner boundary.")
      .def_property_readonly(
          "outer", [](const HarmonicShape& s) { return s.outer; },
          "Coefficients of u on the outer boundary.")
      .def_property_readonly(
          "inner_boundary",
          [](const HarmonicShape& s) {
            return s.annulus.map ? std::optional(s.annulus.map->inner().positions) : std::nullopt;
          },
          "Polygon (V, 2), mm, of an annulus given by its boundaries; None of a circular one.")
      .def_property_readonly(
          "outer_boundary",
          [](const HarmonicShape& s) {
            return s.annulus.map ? std::optional(s.annulus.map->outer().positions) : std::nullopt;
          },
          "As inner_boundary.")
      .def(
          "with_coefficients",
          [](const HarmonicShape& s, const Eigen::VectorXd& inner, const Eigen::VectorXd& outer) {
            requireCoefficients(s.annulus, inner, outer);
            return HarmonicShape{s.annulus, inner, outer};
          },
          "inner"_a, "outer"_a, "The shape of other coefficients in the same annulus.")
      .def_property_readonly("margin", &shapes::boundaryMargin,
                             "Above 0: the 1/2 level is one closed curve or surface.")
      .def(
          "values",
          [](const HarmonicShape& s,
             const Eigen::Ref<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>& points) {
            const Positions at = pointsOf(s, points);
            return unlocked([&] { return shapes::valuesAt(s, at); });
          },
          "points"_a, "u at points (P, 3), mm, or (P, 2) in the plane: (P,), below 1/2 inside.")
      .def(
          "surface",
          [](const HarmonicShape& s, int voxels) {
            requireVoxels(voxels);
            auto mesh = unlocked([&] { return shapes::levelSurface(s, voxels); });
            return std::make_pair(std::move(mesh.positions), std::move(mesh.faces));
          },
          "voxels"_a = 96,
          "The surface, positions (V, 3), mm, and faces (F, 3), of a shape in space.")
      .def(
          "polygon",
          [](const HarmonicShape& s, int voxels) {
            requireVoxels(voxels);
            auto curves = unlocked([&] { return shapes::levelCurves(s, voxels); });
            if (curves.empty()) throw InvalidInput("shape: has no 1/2 level");
            return std::move(curves.front().positions);
          },
          "voxels"_a = 96, "The closed curve (V, 2), mm, of a shape in the plane.")
      .def(
          "field",
          [](const HarmonicShape& s, int voxels) {
            requireVoxels(voxels);
            auto field = unlocked([&] { return shapes::fieldOf(s, voxels); });
            const Eigen::Matrix4d affine = field.grid.affine();
            return std::make_pair(arrayOf(std::move(field)), affine);
          },
          "voxels"_a = 96, "u on a grid around the annulus: (array (I, J, K), affine (4, 4)).");
}

}  // namespace

void bindShapes(py::module_& parent) {
  py::module_ m = parent.def_submodule("shapes");
  bindShape(m);
  m.def(
      "concentric",
      [](int dimension, const Point& centre, double innerRadius, double outerRadius, int order) {
        const HarmonicAnnulus annulus{dimension, centre, innerRadius, outerRadius, order};
        shapes::requireUsable(annulus);
        return shapes::concentricShape(annulus);
      },
      "dimension"_a, "centre"_a, "inner_radius"_a, "outer_radius"_a, "order"_a,
      "The circle or sphere between two others: u is 0 on the inner and 1 on the outer one.");
  m.def(
      "between",
      [](const Positions2& inner, const Positions2& outer, std::optional<int> order) {
        return shapes::concentricShape(unlocked([&] {
          return shapes::givenAnnulus(planar::Curve{inner, true}, planar::Curve{outer, true},
                                      order);
        }));
      },
      "inner_boundary"_a, "outer_boundary"_a, "order"_a = py::none(),
      "The curve half way between two polygons (V, 2), mm, of which one encloses the other: u is\n"
      "0 on the inner and 1 on the outer one.  Order None: as fine as curves in the middle can "
      "be.");
  m.def(
      "band",
      [](const std::vector<Positions2>& targets, double width, std::optional<int> order) {
        std::vector<planar::Curve> curves;
        for (const Positions2& target : targets) {
          curves.push_back({target, true});
          planar::requireUsable(curves.back());
        }
        return shapes::concentricShape(unlocked([&] {
          const shapes::AnnulusBoundaries boundaries = shapes::bandAround(curves, width);
          return shapes::givenAnnulus(boundaries.inner, boundaries.outer, order);
        }));
      },
      "targets"_a, "width"_a, "order"_a = py::none(),
      "As between(), in the band of all points within `width`, mm, of the region between the\n"
      "targets, polygons (V, 2): where shapes can follow them closely.");
  defWithOptions<AroundOptions>(
      m, "around",
      [](const std::vector<py::object>& targets, const py::kwargs& keywords) {
        const auto options = optionsOf<AroundOptions>(keywords);
        std::vector<shapes::TargetSamples> samples;
        int dimension = 0;
        for (const py::object& given : targets) {
          Target target = targetOf(given, options.fit.samples);
          if (dimension != 0 && dimension != target.dimension) {
            throw InvalidInput("targets: those in the plane and in space cannot be mixed");
          }
          dimension = target.dimension;
          samples.push_back(std::move(target.samples));
        }
        return shapes::concentricShape(shapes::annulusAround(samples, dimension, options.annulus));
      },
      "The circle or sphere in the middle of an annulus around targets, polygons (V, 2) or pairs "
      "of\n"
      "positions (V, 3) and faces (F, 3), mm: where the fits of several shapes that are to be\n"
      "combined start.",
      "targets"_a);
  defWithOptions<shapes::ShapeFitOptions>(
      m, "fit",
      [](const py::object& target, const std::optional<HarmonicShape>& start,
         const py::object& progress, const py::kwargs& keywords) {
        const auto options = optionsOf<shapes::ShapeFitOptions>(keywords);
        const Target taken = targetOf(target, options.samples);
        const HarmonicAnnulus annulus =
            start ? start->annulus : shapes::annulusAround({taken.samples}, taken.dimension);
        return fitDict(Watch(progress).run([&](const Monitor& monitor) {
          return shapes::fitShape(annulus, taken.samples, options, monitor);
        }));
      },
      "The shape that differs least from a target, a polygon (V, 2) or a pair of positions (V, 3)\n"
      "and faces (F, 3), mm, in the annulus of `start` (default: around the target).  Returns "
      "shape,\n"
      "history (symmetric_difference in mm^2 or mm^3, distance_mean and distance_max in mm), path\n"
      "(the shape at every entry) and termination.",
      "target"_a, "start"_a = py::none(), "progress"_a = py::none());
  m.def("combine", &shapes::combine, "shapes"_a, "weights"_a,
        "Weighted mean of shapes of one annulus; weights are divided by their sum.");
  m.def(
      "distance",
      [](const py::object& a, const py::object& b) {
        shapes::LevelDistance d;
        if (py::isinstance<py::tuple>(a)) {
          const auto [pa, fa] = a.cast<std::pair<Positions, Faces>>();
          const auto [pb, fb] = b.cast<std::pair<Positions, Faces>>();
          const TriangleMesh from = meshOf(pa, fa), to = meshOf(pb, fb);
          d = unlocked([&] { return shapes::distanceBetween(from, to); });
        } else {
          d = shapes::distanceBetween(planar::Curve{a.cast<Positions2>(), true},
                                      planar::Curve{b.cast<Positions2>(), true});
        }
        return std::make_pair(d.mean, d.max);
      },
      "shape"_a, "target"_a,
      "Mean and largest distance, mm, of the points of one polygon (or surface) from another.");
}

}  // namespace explica::python
