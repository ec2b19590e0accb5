// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Correspondence/Measurement.h"
#include "Explica/Harmonic/Annulus.h"

namespace explica::python {
namespace {

using namespace py::literals;

/// Every option of `explica thickness` that is not a file.
struct ThicknessOptions {
  harmonic::LabelRoles roles;
  correspondence::MeasurementOptions measurement;
};

template <class Visitor>
void describe(correspondence::MeasurementOptions& o, Visitor&& visit) {
  describe(o.annulus, visit);
  describe(o.sulcus, visit);
  describe(o.correspondence, visit);
  describe(o.layers, visit);
}

template <class Visitor>
void describe(ThicknessOptions& o, Visitor&& visit) {
  describe(o.roles, visit);
  describe(o.measurement, visit);
}

/// The same for boundaries that scalar volumes give: labels play no part.
struct LevelThicknessOptions : ThicknessOptions {};

template <class Visitor>
void describe(LevelThicknessOptions& o, Visitor&& visit) {
  describe(o.measurement, visit);
}

/// @param recoverSulci  false: never; true: unless the options speak of a heart
correspondence::Measurement measure(harmonic::Annulus annulus, const ThicknessOptions& options,
                                    bool recoverSulci, const Monitor& monitor) {
  correspondence::MeasurementOptions chosen = options.measurement;
  if (!recoverSulci) chosen.sulci = correspondence::SulciMode::Ignore;
  return correspondence::measure(std::move(annulus), chosen, monitor);
}

py::dict arraysOf(const correspondence::Measurement& m) {
  const auto field = [&](const std::vector<double>& values) {
    return arrayOf(volumeOf(harmonic::spread(m.annulus, values)));
  };
  const correspondence::ThicknessSummary summary = correspondence::summaryOf(m.correspondence);
  return py::dict(
      "harmonic"_a = arrayOf(volumeOf(harmonic::spread(m.annulus, m.interpolant.u, 0, 0, 1))),
      "thickness"_a = field(correspondence::thicknessOf(m.correspondence)),
      "inner_distance"_a = field(m.correspondence.innerDistance),
      "outer_distance"_a = field(m.correspondence.outerDistance), "depth"_a = field(m.depth),
      "inner_point"_a =
          arrayOf(volumeOf(harmonic::spreadPoints(m.annulus, m.correspondence.innerPoint))),
      "outer_point"_a =
          arrayOf(volumeOf(harmonic::spreadPoints(m.annulus, m.correspondence.outerPoint))),
      "layers"_a = arrayOf(volumeOf(harmonic::spreadLabels(m.annulus, m.layers))),
      "valid"_a = arrayOf(volumeOf(harmonic::spreadLabels(m.annulus, correspondence::validOf(m)))),
      "affine"_a = m.annulus.grid.affine(),
      "summary"_a =
          py::dict("voxels"_a = m.annulus.count(), "thickness_mean"_a = summary.mean,
                   "thickness_mean_columns"_a = summary.mean,
                   "thickness_mean_voxels"_a = summary.meanOfVoxels,
                   "thickness_median"_a = summary.median, "thickness_p05"_a = summary.p05,
                   "thickness_p95"_a = summary.p95, "residual"_a = m.interpolant.relativeResidual,
                   "sulcal_voxels_recovered"_a = m.sulcalVoxels.size(),
                   "voxels_without_thickness"_a = m.lost));
}

constexpr const char* kReturns =
    "\n\nReturns a dict of arrays (I, J, K): harmonic (u), thickness, inner_distance and\n"
    "outer_distance (L0, L1, mm), depth, layers, valid; inner_point and outer_point\n"
    "(I, J, K, 3), RAS mm;\n"
    "affine; and summary, the numbers of summary.json.";

}  // namespace

void bindAnnular(py::module_& m) {
  m.def(
      "thickness",
      [](const py::array& labels, const Eigen::Matrix4d& affine, bool sulci,
         const py::object& progress, const py::kwargs& keywords) {
        const auto options = optionsOf<ThicknessOptions>(keywords);
        const Volume<Label> volume = labelVolume(labels, affine);
        return arraysOf(Watch(progress).run([&](const Monitor& monitor) {
          return measure(harmonic::annulusFromLabels(volume, options.roles,
                                                     options.measurement.annulus, monitor),
                         options, sulci, monitor);
        }));
      },
      "labels"_a, "affine"_a, "recover_sulci"_a = true, "progress"_a = py::none(),
      ("Thickness, depth and layers of the tissue between two boundaries of a segmentation." +
       std::string(kReturns) + keywordHelp<ThicknessOptions>())
          .c_str());
  m.def(
      "thickness_of_levels",
      [](const py::array& inner, const py::array& outer, const Eigen::Matrix4d& affine,
         double level, bool sulci, const py::object& progress, const py::kwargs& keywords) {
        const auto options = optionsOf<LevelThicknessOptions>(keywords);
        const Volume<float> in = scalarVolume(inner, affine);
        const Volume<float> out = scalarVolume(outer, affine);
        harmonic::LevelOptions levels{.level = level};
        return arraysOf(Watch(progress).run([&](const Monitor& monitor) {
          return measure(harmonic::annulusFromLevels(in, out, levels, options.measurement.annulus,
                                                     {}, monitor),
                         options, sulci, monitor);
        }));
      },
      "inner"_a, "outer"_a, "affine"_a, "level"_a = 0.0, "recover_sulci"_a = true,
      "progress"_a = py::none(),
      ("As thickness(), between the surfaces where two scalar volumes cross `level`." +
       std::string(kReturns) + keywordHelp<LevelThicknessOptions>())
          .c_str());
  defWithOptions<ThicknessOptions>(
      m, "anatomical_grid",
      [](const py::array& labels, int levels, const Eigen::Matrix4d& affine, bool sulci,
         const py::object& progress, const py::kwargs& keywords) {
        const auto options = optionsOf<ThicknessOptions>(keywords);
        const Volume<Label> volume = labelVolume(labels, affine);
        auto grid = Watch(progress).run([&](const Monitor& monitor) {
          const correspondence::Measurement made =
              measure(harmonic::annulusFromLabels(volume, options.roles,
                                                  options.measurement.annulus, monitor),
                      options, sulci, monitor);
          return correspondence::anatomicalGrid(made.annulus, made.interpolant, levels);
        });
        return py::dict("points"_a = std::move(grid.points), "cells"_a = std::move(grid.cells),
                        "depth"_a = std::move(grid.depth),
                        "thickness"_a = std::move(grid.thickness),
                        "trajectories"_a = grid.trajectories, "lost"_a = grid.lost,
                        "degenerate"_a = grid.degenerate);
      },
      "A grid that follows the tissue: points (P, 3), RAS mm, at equal depths along trajectories,\n"
      "cells (C, 8), hexahedra in VTK's order ((C, 4) of a planar tissue), depth (P,) in [0, 1],\n"
      "thickness (P,) of the trajectory, mm, trajectories, how many were lost, and how many cells\n"
      "were left out because they are degenerate.",
      "labels"_a, "levels"_a, "affine"_a, "recover_sulci"_a = true, "progress"_a = py::none());
  noteKeywords<ThicknessOptions>(m, "thickness");
  noteKeywords<LevelThicknessOptions>(m, "thickness_of_levels");
}

}  // namespace explica::python
