// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Application/Command.h"
#include "Explica/Application/Plausible.h"
#include "Explica/Surface/Summary.h"
#include "Settings.h"

namespace explica::app {
namespace {

void declareSurfaceOutputs(Declaration& d) {
  d.output("white.surf.gii", FileKind::Surface, "white surface")
      .output("mid.surf.gii", FileKind::Surface, "surface at half depth, same faces")
      .output("pial.surf.gii", FileKind::Surface, "outer surface, same faces")
      .output("thickness.shape.gii", FileKind::VertexData,
              "thickness by both measures, mm, the one asked for first; 0 where there is no grey "
              "matter")
      .output("valid.shape.gii", FileKind::VertexData, "1 where the thickness is defined, else 0")
      .output("doubt.shape.gii", FileKind::VertexData,
              "with --image: standard deviation of the white and of the outer border's place, mm; "
              "a voxel where the image shows no border")
      .output("curvature.shape.gii", FileKind::VertexData,
              "mean curvature of the white surface, 1/mm, positive in sulci")
      .output("sulc.shape.gii", FileKind::VertexData,
              "sulcal depth: distance travelled outwards as the white surface is inflated, mm")
      .output("area.shape.gii", FileKind::VertexData,
              "area at each vertex of the white, middle and outer surface, mm^2")
      .output("topology.tsv", FileKind::Table, "one row for each corrected defect")
      .output("regions.tsv", FileKind::Table, "with --atlas: area and thickness of each region")
      .output("regions.label.gii", FileKind::VertexLabel, "with --atlas: region of each vertex")
      .output("*lh.*", FileKind::Any, "with --freesurfer: FreeSurfer files, left")
      .output("*rh.*", FileKind::Any, "with --freesurfer: FreeSurfer files, right");
}

void declareVolumes(Declaration& d, SurfaceSettings& s) {
  d.input("SEG", FileKind::LabelVolume,
          "labels; may be left out if --inner-level or --white-surface is given", s.segmentation)
      .inputOption("inner-level", FileKind::Volume,
                   "scalars that cross a level at the white surface: a probability or a distance",
                   s.innerLevel)
      .inputOption("outer-level", FileKind::Volume,
                   "scalars that cross a level at the outer surface", s.outerLevel)
      .inputOption("grey-share", FileKind::Volume,
                   "probability of grey matter: with --inner-level the outer surface is where both "
                   "together reach one half",
                   s.greyShare)
      .inputOption("insulated-mask", FileKind::LabelVolume,
                   "with --inner-level: nonzero where there is neither white matter nor outside, "
                   "e.g. a cut through the callosum",
                   s.insulatedMask)
      .inputOption("image", FileKind::Volume,
                   "image whose labels these are, such as a T1: white and outer border are placed "
                   "by it, within a voxel of the labels' border",
                   s.image)
      .inputOption("t2", FileKind::Volume,
                   "T2 or FLAIR of the same head beside --image: the outer border is placed by "
                   "both; it is brought onto the image by a rigid motion",
                   s.t2)
      .category("TissueInputs")
      .option("level",
              "value on the boundaries of level volumes (default: half the largest value of "
              "shares, 0 of distances)",
              s.level);
}

}  // namespace

void declareSurface(Declaration& d, SurfaceSettings& s) {
  d.synopsis("inner, middle and outer surface of the cortical ribbon, vertex by vertex")
      .description(
          "From labels, or from volumes that cross a level at the boundaries. The white surface "
          "has the topology of a sphere (each corrected defect is listed), lies between voxels, "
          "and is meshed with even triangles. Outer vertices lie on the trajectories of the "
          "harmonic interpolant that start at the white ones, middle ones half way; the hidden "
          "boundary of buried sulci is recovered. None of the surfaces intersects itself, by an "
          "exact test. Tissue that runs out of the image, such as a block or a slab, gives sheets "
          "with a rim, of the tissue's own topology. Surfaces that another program has made are "
          "taken over as they are with --white-surface and --pial-surface, and measured and "
          "checked in the same way.")
      .reference("Jones, Buchbinder, Aharon 2000, Human Brain Mapping 11:12-32")
      .reference("Han, Pham, Tosun, Rettmann, Xu, Prince 2004, NeuroImage 23:997-1012")
      .reference("Fischl, Dale 2000, Proc. Natl. Acad. Sci. USA 97:11050-11055")
      .reference("Botsch, Kobbelt 2004, Symposium on Geometry Processing, 185-192")
      .example("explica surface aseg.mgz --hemisphere L --out left",
               "Left hemisphere of a FreeSurfer, FastSurfer or SynthSeg segmentation")
      .example("explica surface aseg.mgz --hemisphere L --image brain.mgz --out left",
               "Borders placed by the image, finer than labels do")
      .example(
          "explica surface seg.nii.gz --white-label 3 --grey-label 2 --faces 80000 --out brain",
          "Labels by name")
      .example("explica surface rim.nii.gz --preset laynii --out block",
               "A slab of cortex as LayNii has it, as sheets with a rim")
      .example("explica surface --inner-level wm.nii.gz --grey-share gm.nii.gz --out brain",
               "From tissue probabilities, with sub-voxel boundaries")
      .example(
          "explica surface --white-surface lh.white --pial-surface lh.pial --fs-volume orig.mgz "
          "--surface-space tkr --out left",
          "FreeSurfer's surfaces, checked and measured");
  declareVolumes(d, s);
  d.inputOption("white-surface", FileKind::Surface, "white surface that is there already",
                s.whiteSurface, "Given surfaces")
      .inputOption("pial-surface", FileKind::Surface, "its pial surface, same faces", s.pialSurface,
                   "Given surfaces")
      .inputOption("mid-surface", FileKind::Surface,
                   "its middle surface, same faces (default: half way)", s.midSurface,
                   "Given surfaces")
      .category("Given surfaces")
      .option("surface-space", "frame of their coordinates, if the files do not say",
              s.surfaceSpace)
      .inputOption("atlas", FileKind::LabelVolume,
                   "labels of cortical regions in the same space: writes regions.tsv", s.atlas,
                   "CortexRegions")
      .inputOption("atlas-legend", FileKind::Table,
                   "what its labels are called (default: the .tsv or .nii.txt beside it; "
                   "FreeSurfer's names are known)",
                   s.atlasLegend, "CortexRegions")
      .inputOption("parcellation", FileKind::VertexLabel,
                   "regions of given surfaces, vertex by vertex, instead of --atlas",
                   s.parcellation, "CortexRegions")
      .options("Reading", s.reading)
      .category("Reading")
      .option("scale",
              "multiplies the lengths of the volumes' headers, for such as were scaled to a "
              "human brain's size",
              s.scale)
      .options("Tissue", s.tissue)
      .options("Surface", s.surface)
      .category("Surface")
      .option("sheet",
              "allow open surfaces, which end in rims: where grey matter runs out of the image "
              "(auto), always, never",
              s.sheet)
      .category("Output")
      .option("thickness-measure",
              "what comes first in thickness.shape.gii, and its means: length of the trajectory, "
              "or the mean of the nearest distances both ways, as FreeSurfer has it",
              s.thicknessMeasure)
      .option("freesurfer",
              "write lh.white, lh.pial, lh.thickness and so on, too, into this folder "
              "(within --out if relative)",
              s.freeSurfer)
      .namesOutput("freesurfer")
      .inputOption("fs-volume", FileKind::Volume,
                   "volume (orig.mgz) whose surface RAS FreeSurfer files use, read or written "
                   "(default: the labels, if FreeSurfer's)",
                   s.fsVolume, "Output");
  d.excludes("parcellation", {"atlas", "atlas-legend"})
      .excludes("no-fill", {"fill"})
      .excludes("outer-level", {"grey-share"})
      .needs({"outer-level", "grey-share", "insulated-mask", "level"}, {"inner-level"})
      .needs({"atlas-legend"}, {"atlas"})
      .needs({"fluid", "t2"}, {"image"})
      .needs({"surface-space"}, {"white-surface"});
  declareAccept(d, s.accept);
  declareSurfaceOutputs(d);
  d.results<surface::SurfaceSummary>();
}

}  // namespace explica::app
