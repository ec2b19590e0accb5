// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Segmentation/Atlas.h"
#include "Explica/Segmentation/Hemisphere.h"
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

/// The same for boundaries that shares give: labels play no part.
struct ShareOptions : CortexOptions {};

template <class Visitor>
void describe(ShareOptions& o, Visitor&& visit) {
  describe(o.tissue, [&](const Field& field, auto& value) {
    if (field.name == "hemisphere" || field.name == "close-edges") visit(field, value);
  });
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

/// 1 where an array is not 0.
Volume<std::uint8_t> maskOf(const py::array& mask, const Eigen::Matrix4d& affine) {
  const Volume<float> scalars = scalarVolume(mask, affine);
  Volume<std::uint8_t> result(scalars.grid, 0);
  for (std::size_t v = 0; v < scalars.size(); ++v) result[v] = scalars[v] != 0;
  return result;
}

void bindParts(py::module_& m) {
  m.def(
      "correct_topology",
      [](const py::array& mask, const Eigen::Matrix4d& affine, const std::string& genus,
         const py::object& progress) {
        const auto rule = valueOf<surface::GenusRule>(genus);
        const Volume<std::uint8_t> volume = maskOf(mask, affine);
        auto made = Watch(progress).run([&](const Monitor& monitor) {
          return surface::correctTopology(surface::levelSetOf(volume), rule, monitor);
        });
        py::list defects = defectsOf(made.defects);
        Volume<std::uint8_t> corrected(made.level.grid, 0);
        for (std::size_t v = 0; v < corrected.size(); ++v) corrected[v] = made.level[v] > 0;
        return py::dict("mask"_a = arrayOf(std::move(corrected)),
                        "level"_a = arrayOf(std::move(made.level)), "defects"_a = defects,
                        "voxels_changed"_a = made.voxelsChanged,
                        "handles_left"_a = made.handlesLeft);
      },
      "mask"_a, "affine"_a, "genus"_a = "zero", "progress"_a = py::none(),
      "Make a mask (I, J, K) one ball: no handle, tunnel, island or cavity (genus: zero or keep).\n"
      "Returns mask (uint8), level (its smooth level set, positive inside), the defects "
      "corrected,\n"
      "voxels_changed and handles_left.");
  m.def(
      "iso_surface",
      [](const py::array& level, const Eigen::Matrix4d& affine) {
        const Volume<float> volume = scalarVolume(level, affine);
        auto mesh = unlocked([&] { return geometry::extractIsoSurface(volume); });
        return std::make_pair(std::move(mesh.positions), std::move(mesh.faces));
      },
      "level"_a, "affine"_a,
      "The zero of a level set (I, J, K), positive inside and nowhere 0: closed, oriented, "
      "without\n"
      "self-intersection, positions (V, 3), RAS mm, faces (F, 3).");
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
  defWithOptions<ShareOptions>(
      m, "surfaces_of_shares",
      [](const py::array& whiteShare, const py::array& tissueShare, const Eigen::Matrix4d& affine,
         const py::object& progress, const py::kwargs& keywords) {
        const auto options = optionsOf<ShareOptions>(keywords);
        const Volume<float> inner = scalarVolume(whiteShare, affine);
        const Volume<float> both = scalarVolume(tissueShare, affine);
        return surfacesDict(Watch(progress).run([&](const Monitor& monitor) {
          return surface::buildSurfaces(
              surface::tissueFromShares(inner, both, {}, options.tissue, monitor), options.surface,
              monitor);
        }));
      },
      "As surfaces_of(), from the share of (filled) white matter and the share of white and grey\n"
      "matter in each voxel (I, J, K), in [0, 1]; 0.5 is the boundary.",
      "white_share"_a, "tissue_share"_a, "affine"_a, "progress"_a = py::none());
}

py::dict tissueDict(segmentation::TissueSegmentation made) {
  py::list classes;
  for (const auto& c : made.classes) {
    classes.append(py::dict("mean"_a = c.mean, "deviation"_a = c.deviation, "share"_a = c.share));
  }
  return py::dict("labels"_a = arrayOf(std::move(made.labels)),
                  "csf"_a = arrayOf(std::move(made.probability[0])),
                  "gm"_a = arrayOf(std::move(made.probability[1])),
                  "wm"_a = arrayOf(std::move(made.probability[2])),
                  "bias"_a = arrayOf(std::move(made.bias)), "classes"_a = classes,
                  "termination"_a = std::string(nameOf(made.termination)),
                  "iterations"_a = made.iterations);
}

/// Every option of `explica segment` that is not a file.
struct HemisphereOptions {
  segmentation::TissueOptions tissue;
  segmentation::HemisphereOptions hemisphere;
};

template <class Visitor>
void describe(HemisphereOptions& o, Visitor&& visit) {
  describe(o.tissue, visit);
  describe(o.hemisphere, visit);
}

void bindSegmentation(py::module_& m) {
  defWithOptions<segmentation::TissueOptions>(
      m, "segment",
      [](const py::array& intensity, const Eigen::Matrix4d& affine,
         const std::optional<py::array>& mask, const py::object& progress,
         const py::kwargs& keywords) {
        const auto options = optionsOf<segmentation::TissueOptions>(keywords);
        const Volume<float> volume = scalarVolume(intensity, affine);
        const Volume<Label> brain = mask ? labelVolume(*mask, affine) : Volume<Label>{};
        return tissueDict(Watch(progress).run([&](const Monitor& monitor) {
          return segmentation::segmentTissue(volume, brain, options, monitor);
        }));
      },
      "Tissue classes of a skull-stripped T1 (I, J, K): labels (1 CSF, 2 grey, 3 white), shares "
      "csf,\n"
      "gm and wm in [0, 1], bias (multiplicative), classes (mean, deviation, share of each),\n"
      "termination, iterations.  The brain is where `mask` is not 0, or else intensity above 0.",
      "intensity"_a, "affine"_a, "mask"_a = py::none(), "progress"_a = py::none());
  defWithOptions<HemisphereOptions>(
      m, "segment_hemisphere",
      [](const py::array& intensity, const py::array& atlas, const std::string& legend,
         const Eigen::Matrix4d& affine, const py::object& progress, const py::kwargs& keywords) {
        const auto options = optionsOf<HemisphereOptions>(keywords);
        const Volume<float> volume = scalarVolume(intensity, affine);
        const Volume<Label> labels = labelVolume(atlas, affine);
        const auto meaning = segmentation::parseAtlasLegend(legend, "legend");
        auto made = Watch(progress).run([&](const Monitor& monitor) {
          const auto tissue = segmentation::segmentTissue(volume, {}, options.tissue, monitor);
          return segmentation::extractHemisphere(tissue, labels, meaning, options.hemisphere,
                                                 monitor);
        });
        return py::dict("labels"_a = arrayOf(std::move(made.labels)),
                        "white_share"_a = arrayOf(std::move(made.whiteShare)),
                        "tissue_share"_a = arrayOf(std::move(made.tissueShare)),
                        "white_voxels"_a = made.whiteVoxels, "grey_voxels"_a = made.greyVoxels);
      },
      "One hemisphere of a skull-stripped T1 (I, J, K) by an atlas on its grid and the atlas's "
      "legend\n"
      "(text, one 'value name' a line, named as AAL's): labels (3 white, filled; 2 grey; 1 fluid; "
      "4\n"
      "cut tissue), white_share and tissue_share, whose 0.5 are the white and pial surface.",
      "intensity"_a, "atlas"_a, "legend"_a, "affine"_a, "progress"_a = py::none());
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
  bindParts(m);
  bindSegmentation(m);
}

}  // namespace explica::python
