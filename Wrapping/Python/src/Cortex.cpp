// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Segmentation/Tissue.h"
#include "Explica/Surface/CorticalSurface.h"

namespace explica::python {
namespace {

using namespace py::literals;

/// Every option of `explica surface` that is not a file.
struct CortexOptions {
  surface::TissueOptions tissue;
  surface::SurfaceOptions surface;
};

template <class Visitor>
void describe(CortexOptions& o, Visitor&& visit) {
  describe(o.tissue, visit);
  describe(o.surface, visit);
}

py::dict surfacesDict(surface::CorticalSurfaces made) {
  py::list defects;
  for (const surface::Defect& d : made.white.defects) {
    defects.append(py::dict("kind"_a = std::string(nameOf(d.kind)), "place"_a = d.place,
                            "voxels"_a = d.voxels, "cost"_a = d.cost,
                            "alternative_cost"_a = d.alternativeCost));
  }
  return py::dict(
      "white"_a = std::move(made.white.mesh.positions), "mid"_a = std::move(made.mid.positions),
      "pial"_a = std::move(made.pial.positions), "faces"_a = std::move(made.white.mesh.faces),
      "thickness"_a = std::move(made.thickness), "curvature"_a = std::move(made.curvature),
      "sulcal_depth"_a = std::move(made.sulcalDepth), "defects"_a = defects);
}

}  // namespace

void bindCortex(py::module_& m) {
  m.def(
      "surfaces",
      [](const py::array& labels, const Eigen::Matrix4d& affine, const py::object& progress,
         const py::kwargs& keywords) {
        const auto options = optionsOf<CortexOptions>(keywords);
        const Volume<Label> volume = labelVolume(labels, affine);
        return surfacesDict(Watch(progress).run([&](const Monitor& monitor) {
          return surface::buildSurfaces(surface::tissueFromLabels(volume, options.tissue, monitor),
                                        options.surface, monitor);
        }));
      },
      "labels"_a, "affine"_a, "progress"_a = py::none(),
      ("White, middle and outer surface of the cortical ribbon: vertices (V, 3), RAS mm, that\n"
       "correspond by their number, common faces (F, 3), thickness, curvature and sulcal depth "
       "(V,),\n"
       "and the topological defects that were corrected." +
       keywordHelp<CortexOptions>())
          .c_str());
  m.def(
      "segment",
      [](const py::array& intensity, const Eigen::Matrix4d& affine, const py::object& progress,
         const py::kwargs& keywords) {
        const auto options = optionsOf<segmentation::TissueOptions>(keywords);
        const Volume<float> volume = scalarVolume(intensity, affine);
        auto made = Watch(progress).run([&](const Monitor& monitor) {
          return segmentation::segmentTissue(volume, {}, options, monitor);
        });
        return py::dict("labels"_a = arrayOf(std::move(made.labels)),
                        "csf"_a = arrayOf(std::move(made.probability[0])),
                        "gm"_a = arrayOf(std::move(made.probability[1])),
                        "wm"_a = arrayOf(std::move(made.probability[2])));
      },
      "intensity"_a, "affine"_a, "progress"_a = py::none(),
      ("Tissue classes of a skull-stripped T1: labels (1 CSF, 2 grey, 3 white) and probabilities." +
       keywordHelp<segmentation::TissueOptions>())
          .c_str());
}

}  // namespace explica::python
