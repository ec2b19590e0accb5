// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Harmonic/Phantoms.h"
#include "Explica/Phantom/Cortex.h"
#include "Explica/Phantom/Shell.h"

namespace explica::python {
namespace {

using namespace py::literals;

py::dict annulusDict(harmonic::PhantomKind kind, const harmonic::PhantomOptions& options) {
  harmonic::Phantom phantom;
  harmonic::PhantomAnswers answers;
  unlocked([&] {
    phantom = harmonic::makePhantom(kind, options);
    answers = harmonic::answersOf(phantom);
  });
  py::dict names;
  for (const auto& [name, value] : phantom.labelNames) names[py::str(name)] = value;
  const Eigen::Matrix4d affine = phantom.labels.grid.affine();
  return py::dict("labels"_a = arrayOf(std::move(phantom.labels)), "affine"_a = affine,
                  "label_names"_a = names, "inner_level"_a = arrayOf(std::move(phantom.innerLevel)),
                  "outer_level"_a = arrayOf(std::move(phantom.outerLevel)),
                  "harmonic"_a = arrayOf(std::move(answers.u)),
                  "thickness"_a = arrayOf(std::move(answers.thickness)),
                  "inner_distance"_a = arrayOf(std::move(answers.innerDistance)),
                  "outer_distance"_a = arrayOf(std::move(answers.outerDistance)),
                  "inner_point"_a = arrayOf(std::move(answers.innerPoint)),
                  "outer_point"_a = arrayOf(std::move(answers.outerPoint)));
}

}  // namespace

void bindPhantoms(py::module_& parent) {
  py::module_ m = parent.def_submodule("phantoms");
  defWithOptions<harmonic::PhantomOptions>(
      m, "annulus",
      [](const std::string& kind, const py::kwargs& keywords) {
        return annulusDict(valueOf<harmonic::PhantomKind>(kind),
                           optionsOf<harmonic::PhantomOptions>(keywords));
      },
      "Tissue with exact answers; kind: shell, eccentric, spheroid or ventricle.  A dict of "
      "labels\n"
      "(I, J, K), affine, label_names, inner_level and outer_level (mm, negative inside), and the\n"
      "answers: harmonic, thickness, inner_distance, outer_distance (mm), inner_point and\n"
      "outer_point (I, J, K, 3), RAS mm.",
      "kind"_a);
  defWithOptions<phantom::ShellOptions>(
      m, "shell",
      [](const py::kwargs& keywords) {
        const auto options = optionsOf<phantom::ShellOptions>(keywords);
        auto made = unlocked([&] { return phantom::makeShell(options); });
        const Eigen::Matrix4d affine = made.labels.grid.affine();
        return py::dict("labels"_a = arrayOf(std::move(made.labels)), "affine"_a = affine,
                        "level"_a = arrayOf(std::move(made.level)),
                        "harmonic"_a = arrayOf(std::move(made.harmonic)),
                        "thickness"_a = made.thickness, "inner_radius"_a = made.innerRadius,
                        "outer_radius"_a = made.outerRadius);
      },
      "Concentric spheres in voxels of any shape: labels (I, J, K), 1 inside, 2 tissue; affine;\n"
      "level, the distance from the inner sphere, mm, negative inside; harmonic; thickness,\n"
      "inner_radius and outer_radius, mm.");
  defWithOptions<phantom::CortexOptions>(
      m, "cortex",
      [](const py::kwargs& keywords) {
        const auto options = optionsOf<phantom::CortexOptions>(keywords);
        auto made = unlocked([&] { return phantom::makeCortex(options); });
        const Eigen::Matrix4d affine = made.labels.grid.affine();
        return py::dict("labels"_a = arrayOf(std::move(made.labels)), "affine"_a = affine,
                        "level"_a = arrayOf(std::move(made.level)),
                        "image"_a = arrayOf(std::move(made.image)),
                        "white"_a = py::make_tuple(py::cast(std::move(made.white.positions)),
                                                   py::cast(std::move(made.white.faces))),
                        "thickness"_a = made.thickness);
      },
      "A folded ribbon of constant thickness: labels (1 fluid, 2 grey, 3 white), affine, level "
      "(mm\n"
      "from the white surface, negative inside), image (a noisy T1), white (positions, faces) and\n"
      "thickness, mm.");
}

}  // namespace explica::python
