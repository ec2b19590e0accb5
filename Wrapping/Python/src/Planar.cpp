// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/Contour.h"
#include "Explica/Planar/PolygonCollision.h"
#include "Explica/Planar/PolygonKnotEnergy.h"
#include "Explica/Planar/PolygonMeasures.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonUnfolding.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "Explica/Visibility/Viewpoints.h"

namespace explica::python {
namespace {

using namespace py::literals;
using planar::Curve;
using planar::Point2;
using PolygonIn = Eigen::Ref<const Positions2>;
using Ends = std::optional<std::pair<int, int>>;  ///< first and last vertex of a region

Curve curveOf(const PolygonIn& polygon, bool closed = true) {
  Curve curve{polygon, closed};
  planar::requireUsable(curve);
  return curve;
}

planar::Region regionOf(const Curve& curve, const Ends& region) {
  return region ? planar::regionBetween(curve, region->first, region->second)
                : planar::wholeRegion(curve);
}

using ViewIn = py::array_t<double, py::array::c_style | py::array::forcecast>;
using WeightsIn = std::optional<std::vector<double>>;

/// A viewpoint (2,) or several (N, 2), and their weights: default equal.
planar::Viewpoints viewOf(const ViewIn& view, const WeightsIn& weights) {
  const bool one = view.ndim() == 1 && view.shape(0) == 2;
  if (!one && !(view.ndim() == 2 && view.shape(1) == 2 && view.shape(0) > 0)) {
    throw InvalidInput("viewpoint: one point of two coordinates or an array (N, 2) is needed");
  }
  if (weights && weights->empty()) {
    throw InvalidInput("view_weights: one positive number a viewpoint is needed");
  }
  std::vector<Point> points;
  for (const double* p = view.data(); p != view.data() + view.size(); p += 2) {
    points.emplace_back(p[0], p[1], 0);
  }
  const auto inSpace = visibility::viewpoints(points, weights.value_or(std::vector<double>{}));
  planar::Viewpoints plane{{}, inSpace.weights};
  for (const Point& point : inSpace.points) plane.points.emplace_back(point.head<2>());
  return plane;
}

py::dict frameDict(const planar::PlaneFrame& frame) {
  return py::dict("origin"_a = frame.origin, "x"_a = frame.axisX, "y"_a = frame.axisY);
}

using Contours = std::pair<std::vector<Positions2>, py::dict>;  ///< polygons and their plane

Contours contoursIn(std::vector<Curve> curves, const Grid& grid, int slice) {
  Contours contours;
  for (Curve& curve : curves) contours.first.push_back(std::move(curve.positions));
  contours.second = frameDict(planar::frameOfSlice(grid, slice));
  return contours;
}

py::dict phantomDict(planar::PolygonPhantom phantom) {
  return py::dict("polygon"_a = std::move(phantom.curve.positions),
                  "region"_a = py::make_tuple(phantom.first, phantom.last),
                  "viewpoint"_a = phantom.viewpoint);
}

py::dict iterationOf(const planar::PolygonIteration& i) {
  return py::dict("iteration"_a = i.iteration, "visibility"_a = i.visibility,
                  "flux_variance"_a = i.variance, "length"_a = i.length,
                  "length_error"_a = i.lengthError, "least_distance"_a = i.leastDistance,
                  "knot_energy"_a = i.knotEnergy, "step"_a = i.step, "seconds"_a = i.seconds);
}

py::dict unfoldingDict(planar::PolygonUnfolding made) {
  py::list history, path;
  for (const auto& row : made.history) history.append(iterationOf(row));
  for (auto& state : made.path) path.append(py::cast(std::move(state.positions)));
  return py::dict("polygon"_a = std::move(made.curve.positions),
                  "region_edges"_a = columnOf(planar::edgesOf(made.curve, made.region)),
                  "history"_a = history, "path"_a = path,
                  "termination"_a = std::string(nameOf(made.termination)),
                  "vertices_merged"_a = made.verticesMerged,
                  "self_intersections_initial"_a = rowsOf(made.intersectionsInitial),
                  "self_intersections_final"_a = rowsOf(made.intersectionsFinal));
}

void bindMeasures(py::module_& m) {
  m.def(
      "visibility",
      [](const PolygonIn& polygon, const ViewIn& viewpoint, const Ends& region,
         const WeightsIn& weights) {
        const Curve curve = curveOf(polygon);
        auto v =
            planar::polygonVisibility(curve, regionOf(curve, region), viewOf(viewpoint, weights));
        return py::dict("value"_a = v.average, "flux_variance"_a = v.variance,
                        "length"_a = v.length, "edge_flux"_a = std::move(v.edgeFlux),
                        "gradient"_a = std::move(v.gradient));
      },
      "polygon"_a, "viewpoint"_a, "region"_a = py::none(), "view_weights"_a = py::none(),
      "Average visibility of a region (first and last vertex; default: all) of a polygon (V, 2),\n"
      "mm, from a viewpoint (2,): value in [-1, 1], its gradient (V, 2) in 1/mm, which ascends,\n"
      "flux_variance, length in mm, and edge_flux, the mean flux of each region edge.  Of several\n"
      "viewpoints (N, 2) the means by view_weights (N,), positive (default: equal).");
  m.def(
      "visible_part",
      [](const PolygonIn& polygon, const ViewIn& viewpoint, const Ends& region,
         const WeightsIn& weights) {
        const Curve curve = curveOf(polygon);
        auto seen = planar::visiblePart(curve, regionOf(curve, region), viewOf(viewpoint, weights));
        return py::dict("fraction"_a = seen.fraction, "real_visibility"_a = seen.realVisibility,
                        "edge_seen"_a = std::move(seen.edgeSeen));
      },
      "polygon"_a, "viewpoint"_a, "region"_a = py::none(), "view_weights"_a = py::none(),
      "What is truly seen of a region from a viewpoint (2,), mm, exactly: fraction of its length,\n"
      "real_visibility, the flux that arrives over that length,\n"
      "and edge_seen, the seen share of each region edge.  Of several viewpoints (N, 2) the means\n"
      "by view_weights (N,), positive (default: equal).");
  m.def(
      "knot_energy",
      [](const PolygonIn& polygon, std::optional<std::vector<bool>> moves,
         const std::string& method, double openingRatio) {
        const Curve curve = curveOf(polygon);
        const std::vector<bool> every(static_cast<std::size_t>(curve.vertexCount()), true);
        auto value = unlocked([&] {
          const auto energy = planar::makePolygonKnotEnergy(
              valueOf<planar::PolygonKnot>(method), curve, moves ? *moves : every, openingRatio);
          if (!energy) throw InvalidInput("method: 'off' has no energy");
          return energy->evaluate(curve.positions);
        });
        return std::make_pair(value.value, std::move(value.gradient));
      },
      "polygon"_a, "moves"_a = py::none(), "method"_a = "all-pairs", "opening_ratio"_a = 0.25,
      "Knot energy of a polygon (V, 2), mm, and its gradient (V, 2), which motion descends; "
      "`moves`\n"
      "(V,) marks the vertices that may move.  method: 'all-pairs' (exact) or 'tree'.");
  m.def(
      "largest_safe_step",
      [](const PolygonIn& polygon, const PolygonIn& target) {
        const Curve curve = curveOf(polygon);
        if (target.rows() != polygon.rows() || !target.allFinite()) {
          throw InvalidInput("target: one finite row a vertex of the polygon is needed");
        }
        const std::vector<bool> moving(static_cast<std::size_t>(curve.vertexCount()), true);
        const double reach = 2 * (target - polygon).rowwise().norm().maxCoeff();
        const auto pairs =
            planar::nearbyPairs(curve, moving, planar::edgeLengths(curve), reach, reach);
        return planar::largestSafeStep(curve, target, pairs);
      },
      "polygon"_a, "target"_a,
      "Largest t found in [0, 1] such that no vertex meets an edge while all vertices go straight\n"
      "from polygon (V, 2) to target (V, 2), mm: never beyond the true contact.");
  m.def(
      "self_intersections",
      [](const PolygonIn& polygon, bool closed) {
        return rowsOf(planar::intersectingEdges(curveOf(polygon, closed)));
      },
      "polygon"_a, "closed"_a = true,
      "Pairs of edges that share more than their common vertex, (N, 2); decided exactly.");
  m.def(
      "edge_lengths",
      [](const PolygonIn& polygon, bool closed) {
        return planar::edgeLengths(curveOf(polygon, closed));
      },
      "polygon"_a, "closed"_a = true, "Length of every edge, mm, (E,).");
  m.def("signed_area", &planar::signedArea, "polygon"_a,
        "Area, mm^2; positive if the polygon (V, 2) runs counter-clockwise.");
  m.def(
      "hidden_viewing_arc",
      [](const PolygonIn& polygon, const Point2& centre, double radius) {
        return planar::hiddenViewingArc(curveOf(polygon), centre, radius);
      },
      "polygon"_a, "centre"_a, "radius"_a,
      "Arc of the viewing circle that a polygon hides from its own points, integrated over them,\n"
      "mm^2.");
  m.def(
      "self_occlusion",
      [](const PolygonIn& polygon) { return planar::selfOcclusion(curveOf(polygon)); }, "polygon"_a,
      "Length by which a polygon hides itself, mm^2; 0 for a convex one.");
}

void bindContours(py::module_& m) {
  m.def(
      "contours_of_label",
      [](const py::array& labels, const Eigen::Matrix4d& affine, int label,
         std::optional<int> slice, double smoothing) {
        const Volume<Label> volume = labelVolume(labels, affine);
        const int k = slice.value_or(planar::largestSlice(volume, label));
        if (k < 0) throw InvalidInput("label: " + std::to_string(label) + " is absent");
        return contoursIn(planar::contoursOfLabel(volume, label, k, {smoothing}), volume.grid, k);
      },
      "labels"_a, "affine"_a, "label"_a, "slice"_a = py::none(),
      "smoothing"_a = planar::ContourOptions{}.smoothing,
      "Contours of a label in a slice along the third axis (default: where it is largest), "
      "sub-pixel:\n"
      "a list of polygons (V, 2), mm, largest first, counter-clockwise around the label and "
      "clockwise\n"
      "around holes; and the plane: origin, x and y, RAS, by which (a, b) is origin + a x + b y.");
  m.def(
      "contours_of_level",
      [](const py::array& field, const Eigen::Matrix4d& affine, double level, int slice) {
        const Volume<float> volume = scalarVolume(field, affine);
        if (slice < 0 || slice >= volume.grid.size[2]) {
          throw InvalidInput("slice: " + std::to_string(slice) + " is not one of 0.." +
                             std::to_string(volume.grid.size[2] - 1));
        }
        return contoursIn(planar::contoursOfSlice(volume, slice, level), volume.grid, slice);
      },
      "field"_a, "affine"_a, "level"_a, "slice"_a = 0,
      "As contours_of_label(), where a scalar slice crosses a level; higher values inside.");
  m.def(
      "resample",
      [](const PolygonIn& polygon, int edges) {
        return planar::resampled(curveOf(polygon), edges).positions;
      },
      "polygon"_a, "edges"_a, "The closed curve by `edges` edges of equal arc length, (edges, 2).");
}

void bindFiles(py::module_& m) {
  m.def(
      "read_polygon", [](const std::filesystem::path& path) { return io::readPolygon(path); },
      "path"_a, "A closed polygon (V, 2), mm, of a text or VTK file.");
  m.def(
      "write_polygon",
      [](const std::filesystem::path& path, const PolygonIn& polygon) {
        if (path.extension() == ".vtp") return io::writePolygonVtp(path, polygon);
        io::writePolygonCsv(path, polygon);
      },
      "path"_a, "polygon"_a,
      "Write a polygon (V, 2): .vtp as VTK polydata, any other name as CSV.");
}

void bindExamples(py::module_& m) {
  m.def(
      "polygon19", [] { return phantomDict(planar::makePolygon19()); },
      "A polygon (V, 2) with an intricate region of 19 edges, that region (first and last vertex)\n"
      "and the viewpoint (2,) from which it is to be seen.");
  m.def(
      "polygon34", [] { return phantomDict(planar::makePolygon34()); },
      "As polygon19(), with a highly convoluted region of 34 edges.");
  m.def(
      "circle",
      [](int edges, double radius, const Point2& centre) {
        return planar::makeCircle(edges, radius, centre).positions;
      },
      "edges"_a, "radius"_a = 1.0, "centre"_a = Point2(0, 0),
      "Circle by chords, counter-clockwise, (edges, 2).");
  m.def(
      "ellipse",
      [](int edges, double a, double b) { return planar::makeEllipse(edges, a, b).positions; },
      "edges"_a, "a"_a, "b"_a, "Ellipse of semi-axes a (along x) and b, (edges, 2).");
}

}  // namespace

void bindPlanar(py::module_& parent) {
  py::module_ m = parent.def_submodule("planar");
  bindMeasures(m);
  bindContours(m);
  bindFiles(m);
  bindExamples(m);
  defWithOptions<planar::PolygonUnfoldingOptions>(
      m, "unfold",
      [](const PolygonIn& polygon, const Ends& region, const ViewIn& viewpoint,
         const py::object& progress, const WeightsIn& weights, const py::kwargs& keywords) {
        const auto options = optionsOf<planar::PolygonUnfoldingOptions>(keywords);
        const Curve curve = curveOf(polygon);
        const planar::Region chosen = regionOf(curve, region);
        const planar::Viewpoints view = viewOf(viewpoint, weights);
        return unfoldingDict(Watch(progress).run([&](const Monitor& monitor) {
          return planar::unfoldPolygon(curve, chosen, view, options, monitor);
        }));
      },
      "Move the region (first and last vertex; None: all) of a polygon (V, 2), mm, until it is "
      "seen\n"
      "from a viewpoint (2,), or from several (N, 2) with view_weights (N,), positive (default:\n"
      "equal), its edges' lengths kept.  Returns polygon (V, 2), region_edges,\n"
      "history (one dict an iteration), path (the positions at every entry of it), termination, "
      "and\n"
      "the pairs of edges that intersect, self_intersections_initial and _final (N, 2).\n"
      "`progress(fraction, activity)` may return False to stop.",
      "polygon"_a, "region"_a, "viewpoint"_a, "progress"_a = py::none(),
      "view_weights"_a = py::none());
}

}  // namespace explica::python
