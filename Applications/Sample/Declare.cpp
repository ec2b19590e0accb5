// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Settings.h"

#include "Explica/Application/Declaration.h"
#include "Explica/Sampling/Summary.h"

namespace explica::app {

void declareSample(Declaration& d, SampleSettings& s) {
  d.synopsis("values of volumes on the cortex: at depths between surfaces, or layer by layer")
      .description(
          "Takes volumes (anatomy, maps, functional series, labels) at any depth between a white "
          "and a pial surface whose vertices correspond, or in the layers of explica thickness. "
          "Outside the field of view or the mask, and where a map holds NaN, a value is not known: "
          "it is NaN, valid.shape.gii says where, and no statistic counts it. A functional series "
          "is read some frames at a time. The volume's header says where it lies; if it lies "
          "elsewhere than the surface, --to-volume brings places of the surface to places of the "
          "volume.")
      .reference("Waehnert and others 2014, NeuroImage 93:210-220 (depths of equal volume)")
      .example(
          "explica sample bold.nii.gz --surfaces sub-01/anat --hemisphere L --depths 5 --to-volume "
          "from-boldref_to-T1w.txt --labels lh.aparc.annot --out sampled",
          "A functional series at five depths, and its profile in each region")
      .example("explica sample t1map.nii.gz --thickness thickness --depths 20 --out layers",
               "Twenty layers along the trajectories of explica thickness")
      .input("VOLUME", FileKind::Volume, "volumes to sample, of one or several frames", s.volumes)
      .inputOption("label-volume", FileKind::LabelVolume,
                   "volume of labels, which go to the majority; may be repeated", s.labelVolumes);
  declareCortex(d, s.cortex, "Surfaces");
  d.options("Surfaces", s.cortex.reading)
      .inputOption("thickness", FileKind::Folder,
                   "output folder of explica thickness: sample its layers instead of surfaces",
                   s.thickness, "Trajectories")
      .category("Depths")
      .option("depths",
              "number of depths from white to pial, or a list: 0 white to 1 pial (default 0.5); "
              "with --thickness the number of layers (default: those of its layers.nii.gz)",
              s.depths)
      .option("depth-kind", "depths are shares of the distance or of the column's volume",
              s.depthKind)
      .option("across",
              "one map of all depths: their mean or maximum, of labels the most frequent; ribbon: "
              "mean over the volume of the faces about a vertex, as Workbench's ribbon mapping",
              s.across)
      .category("Values")
      .option("interpolate", "how values between voxel centres are made", s.interpolate)
      .inputOption("mask", FileKind::Volume,
                   "where it is 0, on the volumes' grid, nothing is known", s.mask, "Values")
      .options("Values", s.reading);
  declarePlace(d, s.place, "Place");
  d.inputOption("labels", FileKind::VertexLabel,
                "regions on the surface (GIFTI, annot, .label; several files may overlap), or with "
                "--thickness one label volume: writes a profile for each",
                s.labels, "Regions")
      .inputOption("points", FileKind::Table,
                   "table with columns x, y, z (RAS mm): finds vertex, depth, distance, region",
                   s.points, "Regions")
      .output("*.func.gii", FileKind::VertexData,
              "NAME.func.gii: a map a depth; of a series NAME_depth-D.func.gii: a map a frame; "
              "with --across NAME.func.gii")
      .output(
          "*.label.gii", FileKind::VertexLabel,
          "NAME.label.gii of a label volume; NAME_depth-D.label.gii if there are several depths")
      .output("valid.shape.gii", FileKind::VertexData,
              "1 where the value is known (of a series, in every frame), a map a volume and depth")
      .output("profiles.tsv", FileKind::Table, "volume, region, depth, mean, sd, n")
      .output("points.tsv", FileKind::Table,
              "with --points: nearest vertex, depth, distance in mm, region")
      .output("*_layers.tsv", FileKind::Table,
              "with --thickness NAME_layers.tsv: mean, sd, voxels, volume in mm^3, mean of columns")
      .results<sampling::SampleSummary>();
  d.find("VOLUME")->required = false;
}

}  // namespace explica::app
