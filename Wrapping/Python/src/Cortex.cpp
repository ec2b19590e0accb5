// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Maps/Folding.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/TissueSheet.h"

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

py::list defectsOf(const std::vector<surface::Defect>& defects) {
  py::list list;
  for (const surface::Defect& d : defects) {
    list.append(py::dict("kind"_a = std::string(nameOf(d.kind)), "place"_a = d.place,
                         "voxels"_a = d.voxels, "cost"_a = d.cost,
                         "alternative_cost"_a = d.alternativeCost));
  }
  return list;
}

py::dict surfacesDict(surface::CorticalSurfaces made) {
  return py::dict(
      "white"_a = std::move(made.white.mesh.positions), "mid"_a = std::move(made.mid.positions),
      "pial"_a = std::move(made.pial.positions), "faces"_a = std::move(made.white.mesh.faces),
      "thickness"_a = std::move(made.thickness), "curvature"_a = std::move(made.curvature),
      "sulcal_depth"_a = std::move(made.sulcalDepth), "defects"_a = defectsOf(made.white.defects));
}

/// Maps of a folded surface.
void bindFolding(py::module_& m) {
  m.def(
      "mean_curvature",
      [](const Eigen::Ref<const Positions>& positions, const Eigen::Ref<const Faces>& faces,
         std::optional<double> fwhm) {
        const TriangleMesh mesh = meshOf(positions, faces);
        return unlocked([&] { return maps::meanCurvature(mesh, fwhm); });
      },
      "positions"_a, "faces"_a, "fwhm"_a = py::none(),
      "Mean curvature at vertices (V,), mm^-1, diffused by `fwhm` mm (None: 0.0188 of the square\n"
      "root of the area, 5 mm for a human hemisphere): positive in sulci, -1/R on a sphere.");
  m.def(
      "sulcal_depth",
      [](const Eigen::Ref<const Positions>& positions, const Eigen::Ref<const Faces>& faces) {
        const TriangleMesh mesh = meshOf(positions, faces);
        return unlocked([&] { return maps::sulcalDepth(mesh); });
      },
      "positions"_a, "faces"_a,
      "Signed distance (V,), mm, that vertices travel outwards while a closed surface is "
      "inflated:\n"
      "positive in sulci, mean 0 over the area.");
}

}  // namespace

void bindCortex(py::module_& m) {
  defWithOptions<CortexOptions>(
      m, "surfaces_of",
      [](const py::array& labels, const Eigen::Matrix4d& affine,
         const std::optional<py::array>& image, const py::object& progress,
         const py::kwargs& keywords) {
        const auto options = optionsOf<CortexOptions>(keywords);
        const Volume<Label> volume = labelVolume(labels, affine);
        const Volume<float> brightness = image ? scalarVolume(*image, affine) : Volume<float>{};
        return surfacesDict(Watch(progress).run([&](const Monitor& monitor) {
          const auto masks = surface::masksFromLabels(volume, options.tissue, monitor);
          if (surface::isBlock(masks) && !options.tissue.closeEdges && !image) {
            return surface::buildSheets(masks, options.surface, monitor);
          }
          const auto tissue = surface::tissueFromMasks(masks, options.tissue.closeEdges, monitor);
          return image ? surface::buildSurfaces(tissue, brightness, options.surface, monitor)
                       : surface::buildSurfaces(tissue, options.surface, monitor);
        }));
      },
      "White, middle and outer surface of the cortical ribbon: white, mid and pial, vertices (V, "
      "3),\n"
      "RAS mm, that correspond by their number, common faces (F, 3), thickness and sulcal_depth "
      "in\n"
      "mm and curvature in mm^-1, (V,), and the topological defects that were corrected.  Tissue\n"
      "that runs out of the image gives sheets with a rim.  With an `image` on the labels' grid, "
      "such\n"
      "as a T1, both borders are placed by it.",
      "labels"_a, "affine"_a, "image"_a = py::none(), "progress"_a = py::none());
  bindFolding(m);
}

}  // namespace explica::python
