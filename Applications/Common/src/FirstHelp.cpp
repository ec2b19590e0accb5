// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The one table of what each command shows at first.  A new command adds its row; a new option is
// named here only if most people need it, and then takes another one's place.

#include "FirstHelp.h"

#include <algorithm>

namespace explica::app {

const std::vector<FirstHelp>& allFirstHelp() {
  static const std::vector<FirstHelp> all = {
      {"bids",
       "a BIDS data set: segmentations, FreeSurfer subjects or T1 images",
       "a derivative with surfaces, thickness and unfolded patches, and a table of the study",
       {"participant-label", "hemisphere", "steps", "template", "include", "model",
        "unfold-surface", "given-surfaces", "unfold.center", "unfold.direction", "unfold.radius"},
       R"(explica phantom cortex --size 32 --spacing 2 --out phantom
mkdir -p data/sub-01/anat
cp phantom/labels.nii.gz data/sub-01/anat/sub-01_dseg.nii.gz
echo '{"Name": "phantoms", "BIDSVersion": "1.8.0"}' > data/dataset_description.json
explica bids data derived participant --hemisphere L --steps thickness,surface --surface.faces 2000
explica bids data derived group)"},
      {"cifti",
       "vertex data of the left and the right hemisphere",
       "one CIFTI file: maps, a series or labels, the medial wall left out",
       {"left", "right", "left-cortex", "right-cortex", "name", "seconds"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica cifti --left surfaces/thickness.shape.gii --right surfaces/thickness.shape.gii \
  --name thickness --out cifti)"},
      {"compare",
       "a surface, and others with the same vertices: flat maps, inflated ones, spheres",
       "what each of them keeps of areas, lengths, angles and distances, as a table and pictures",
       {"label", "label-key", "pairs", "sources", "local-limit"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica compare surfaces/white.surf.gii surfaces/pial.surf.gii --out compared)"},
      {"descriptors",
       "the commands' own declarations",
       "descriptions for Boutiques, bash, zsh and man",
       {},
       "explica descriptors --out descriptors"},
      {"embed",
       "closed contours (CSV, label images) or surfaces",
       "amplitudes in a common annulus, and the fitted, mean or combined shape",
       {"fit", "average", "combine", "label-key", "slice", "order", "max-iterations", "frames"},
       R"(explica phantom shell --size 32 --out shell
explica embed shell/labels.nii.gz --label-key 1 --order 8 --out fit)"},
      {"figure",
       "surfaces of one or both hemispheres, flat maps, per-vertex maps and annotations",
       "one figure for print, as PNG and as SVG in layers",
       {"views", "layout", "size", "colours", "range"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica surface cortex/labels.nii.gz --white-label 3 --grey-label 2 --faces 2000 --out surfaces
explica figure surfaces/pial.surf.gii surfaces/thickness.shape.gii --size 800 --out figure)"},
      {"flatten",
       "an unfolded patch, a part of a surface, or a hemisphere with cuts",
       "a flat map without folds, as surface, table, picture and stack of depths",
       {"vertex", "radius", "label", "cuts", "cortex", "area-tolerance", "grid", "surfaces",
        "volumes", "to-volume", "map", "regions", "max-time", "resume"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica unfold surfaces/pial.surf.gii --center 0,0,12 --radius 8 --direction 0,0,1 --surround none --out unfolded
explica flatten unfolded/unfolded.surf.gii --surfaces surfaces --volumes shell/level.nii.gz --out flat)"},
      {"glm",
       "people's maps or a table of regions, and what is known of the people",
       "where an effect is, how large, and whether it is real: maps, tables and a page",
       {"maps", "table", "person", "model", "contrast", "surface", "mask", "site", "permutations",
        "tfce", "threshold"},
       R"(printf 'participant_id,age,thickness\ns1,20,2.6\ns2,30,2.5\ns3,40,2.5\ns4,50,2.3\ns5,60,2.2\n' > people.csv
explica glm people.csv --model 'thickness ~ age' --permutations 100 --out glm)"},
      {"heart",
       "label volumes of the left ventricle: 4-D, or one a frame",
       "segments, volumes and masses over time, thickness and thickening, a bullseye",
       {"preset", "cavity", "wall", "rv", "phases", "rv-insertion"},
       R"(explica phantom ventricle --size 64 --spacing 2 --slice 8 --frames 2 --out beat
explica heart beat/frame-0000.nii.gz beat/frame-0001.nii.gz --out heart)"},
      {"history",
       "any result, or a record",
       "the commands and files that it came from, back to the first",
       {},
       R"(explica phantom shell --size 24 --out shell
explica history shell/labels.nii.gz)"},
      {"inflate",
       "a closed surface, such as a hemisphere",
       "the surface opened as a whole until its folds are seen, areas kept, nowhere through itself",
       {"target-seen", "frames", "max-time", "resume", "repair"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica surface cortex/labels.nii.gz --white-label 3 --grey-label 2 --faces 2000 --out surfaces
explica inflate surfaces/white.surf.gii --out inflated)"},
      {"longitudinal",
       "T1s of one person, in the order of time",
       "thickness of each session at the same places of the person's own template, and its change",
       {"hemisphere", "atlas", "template", "segment.template", "segment.stripped", "surface.faces"},
       R"(explica phantom cortex --size 48 --out first
explica phantom cortex --size 48 --seed 2 --out second
explica longitudinal first/t1.nii.gz second/t1.nii.gz --hemisphere L --out change --dry-run)"},
      {"parcellate",
       "a folder with a sphere in register with a template, and the template's labels",
       "regions at the surface's vertices, and how sure they are",
       {"atlas", "template", "hemisphere", "volume", "like", "ribbon"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --atlas shell/labels.nii.gz \
  --out surfaces
cp surfaces/white.surf.gii surfaces/sphere.reg.surf.gii
explica parcellate surfaces --atlas surfaces/regions.label.gii --hemisphere L --out regions)"},
      {"phantom cortex",
       "sizes",
       "a folded ribbon: labels, T1-like image and exact white surface",
       {"size", "spacing", "thickness", "depth", "waves", "noise"},
       "explica phantom cortex --size 48 --out cortex"},
      {"phantom eccentric",
       "sizes",
       "a tissue between two spheres that share no centre, and its exact thickness",
       {},
       "explica phantom eccentric --size 64 --spacing 2 --out eccentric"},
      {"phantom folds",
       "sizes, how steep",
       "a sheet in overhanging folds, and the region of it to unfold",
       {},
       R"(explica phantom folds --edge 2 --out folds
explica unfold folds/folds.surf.gii --label folds/region.label.gii --direction 0,0,1 --out open)"},
      {"phantom polygon19",
       "a pixel's size",
       "a folded polygon with region and viewpoint",
       {},
       R"(explica phantom polygon19 --out p19
explica polygon p19/polygon.csv --region 0:19 --viewpoint 50.5,4000 --out open)"},
      {"phantom polygon34",
       "a pixel's size",
       "a folded polygon with region and viewpoint",
       {},
       R"(explica phantom polygon34 --out p34
explica polygon p34/polygon.csv --region 0:34 --viewpoint 80.9,4000 --out open)"},
      {"phantom shell",
       "sizes",
       "a tissue between two spheres: labels, levels, exact thickness and correspondences",
       {},
       R"(explica phantom shell --size 48 --out shell
explica thickness shell/labels.nii.gz --inner 1 --tissue 2 --out thickness)"},
      {"phantom spheroid",
       "sizes",
       "a tissue between two spheroids of one focus, and its exact thickness",
       {},
       "explica phantom spheroid --size 64 --spacing 2 --out spheroid"},
      {"phantom ventricle",
       "sizes",
       "half a spheroidal shell, open at the base, as a heart's left ventricle",
       {},
       "explica phantom ventricle --size 64 --spacing 2 --out ventricle"},
      {"polygon",
       "a closed polygon, or the contour of a label in a slice",
       "the polygon with its region unfolded, its stages as a picture, a table of the way",
       {"region", "viewpoint", "direction", "label-key", "slice", "phantom", "surround", "method",
        "target-visibility", "max-iterations", "frames", "resume"},
       R"(explica phantom polygon34 --out p34
explica polygon p34/polygon.csv --region 0:34 --viewpoint 80.9,4000 --out flat)"},
      {"regions",
       "a folder with surfaces or maps, and an annotation of their vertices",
       "area, volume, thickness, curvature and any map by region: FreeSurfer's table and a long "
       "one",
       {"atlas", "map", "hemisphere", "person"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --atlas shell/labels.nii.gz \
  --out surfaces
explica regions surfaces --atlas surfaces/regions.label.gii --hemisphere L --out tables)"},
      {"register",
       "a sphere with sulcal depth and curvature beside it, and a template or another person",
       "the sphere in the template's frame: equal places have equal folds, one to one",
       {"template", "to", "sulc", "curvature", "surfaces", "mirror", "smoothness", "max-areal"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica surface cortex/labels.nii.gz --white-label 3 --grey-label 2 --faces 2000 --out surfaces
explica sphere surfaces/white.surf.gii --out sphere
explica register sphere/sphere.surf.gii --surfaces surfaces --to sphere/sphere.surf.gii \
  --to-sulc surfaces/sulc.shape.gii --to-curvature surfaces/curvature.shape.gii --out registered)"},
      {"repair",
       "a triangulated surface, or several with the same faces",
       "the surface with crossing faces parted, the same vertices and faces",
       {"max-move"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica repair surfaces/white.surf.gii surfaces/pial.surf.gii --out repaired)"},
      {"replay",
       "the record of a run",
       "the same command run again, and which of its outputs are identical",
       {},
       R"(explica phantom shell --size 24 --out shell
explica replay shell/provenance.json --out again)"},
      {"report",
       "an output folder of a command or of explica run",
       "one page for a browser, report.html in that folder",
       {},
       R"(explica phantom shell --size 32 --out shell
explica thickness shell/labels.nii.gz --inner 1 --tissue 2 --out thickness
explica report thickness)"},
      {"resample",
       "per-vertex maps, labels or surfaces, and the sphere of their vertices",
       "the same at the vertices of another sphere in register, such as fsaverage5's",
       {"from", "to", "template", "space", "method", "areas", "amounts"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica resample surfaces/thickness.shape.gii --from surfaces/white.surf.gii --to fsaverage3 \
  --out on-fsaverage3)"},
      {"run",
       "a T1, a label volume, a FreeSurfer subject or an anat folder of fMRIPrep",
       "tissues, thickness, surfaces, their place on a template, an unfolded patch, and a report",
       {"atlas", "template", "kind", "hemisphere", "unfold-surface", "given-surfaces", "steps",
        "resume", "unfold.center", "unfold.direction", "unfold.radius"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica run cortex/labels.nii.gz --surface.faces 2000 --unfold.max-iterations 5 --out result \
  || [ $? -eq 3 ])"},
      {"sample",
       "volumes, and a white and a pial surface or a folder of explica thickness",
       "maps of the values at each depth, where they are known, profiles of regions",
       {"surfaces", "hemisphere", "white", "pial", "thickness", "depths", "depth-kind", "across",
        "interpolate", "to-volume", "mask", "labels", "points"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica sample shell/harmonic.nii.gz --surfaces surfaces --depths 5 --out sampled)"},
      {"segment",
       "a T1-weighted image without skull; an atlas in its space tells hemispheres apart",
       "labels (1 CSF, 2 grey, 3 white), probabilities of each, one hemisphere",
       {"mask", "atlas", "hemisphere", "smooth", "bias-width", "max-iterations"},
       R"(explica phantom cortex --size 48 --out cortex
explica segment cortex/t1.nii.gz --out tissue)"},
      {"smooth",
       "per-vertex maps, and the surface of their vertices",
       "the maps diffused along the surface, and how smooth they are",
       {"surface", "fwhm", "mask"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica smooth surfaces/thickness.shape.gii --surface surfaces/mid.surf.gii --fwhm 5 --out smooth)"},
      {"sphere",
       "a closed surface, such as a hemisphere's white surface",
       "the surface one to one on a sphere, and what that does to areas and shapes",
       {"balance", "tolerance", "max-iterations"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica surface cortex/labels.nii.gz --white-label 3 --grey-label 2 --faces 2000 --out surfaces
explica sphere surfaces/white.surf.gii --out sphere)"},
      {"study check",
       "a study file",
       "what each run would do, or the first fault with its line and remedy",
       {},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
echo '{"hemispheres": ["L"], "input": "cortex/labels.nii.gz", "subjects": ["01"]}' > study.json
explica study check study.json)"},
      {"study group",
       "a study file, and the folder of its results",
       "a table and a page with a row for every run; people together on their template",
       {"include", "model", "fwhm"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
echo '{"hemispheres": ["L"], "input": "cortex/labels.nii.gz", "subjects": ["01"],
  "parameters": {"steps": ["thickness"]}}' > study.json
explica study participant study.json results
explica study group study.json results)"},
      {"study hearts",
       "a folder with a folder of label volumes for each person",
       "a table with a row a person, a page of bull's-eyes, each heart's results",
       {"participant-label", "endings", "preset", "phases"},
       R"(explica phantom ventricle --size 64 --spacing 2 --slice 8 --frames 2 --out beat
mkdir -p data/sub-01
cp beat/frame-0000.nii.gz data/sub-01/sub-01_frame-ED_dseg.nii.gz
cp beat/frame-0001.nii.gz data/sub-01/sub-01_frame-ES_dseg.nii.gz
explica study hearts data hearts)"},
      {"study list",
       "a study file",
       "the labels of its subjects, or of those that are not done",
       {},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
echo '{"hemispheres": ["L"], "input": "cortex/labels.nii.gz", "subjects": ["01"]}' > study.json
explica study list study.json)"},
      {"study participant",
       "a study file",
       "the results of its subjects, a folder for each hemisphere and region",
       {},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
echo '{"hemispheres": ["L"], "input": "cortex/labels.nii.gz", "subjects": ["01"],
  "parameters": {"steps": ["thickness"]}}' > study.json
explica study participant study.json results)"},
      {"study schema",
       "the declarations of explica run",
       "the JSON schema of study files",
       {},
       "explica study schema > study.schema.json"},
      {"surface",
       "labels of white and grey matter, or volumes that cross a level at their borders",
       "white, middle and pial surface with the same faces; thickness, curvature, depth of sulci",
       {"preset", "white-label", "grey-label", "fill", "hemisphere", "genus", "faces",
        "inner-level", "outer-level", "atlas", "white-surface", "pial-surface", "freesurfer"},
       R"(explica phantom shell --size 48 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 4000 --out surfaces)"},
      {"template",
       "two people or more: folders of run, FreeSurfer subjects, or a study's",
       "their mean folds, surfaces and regions, for --template of register and parcellate",
       {"density", "iterations"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica phantom cortex --size 36 --spacing 2 --out other
for one in cortex other; do
  explica run $one/labels.nii.gz --hemisphere L --steps surface,sphere --surface.faces 2000 --out run-$one
done
explica template run-cortex run-other --density fsaverage3 --level 3 --out template || [ $? -eq 3 ])"},
      {"thickness",
       "a label volume, or two volumes that cross a level at the boundaries",
       "thickness in every voxel of the tissue, depth, layers, points that correspond",
       {"inner", "tissue", "outer", "insulated", "inner-level", "outer-level", "boundary", "method",
        "layers", "layer-kind", "sulci", "per-slice"},
       R"(explica phantom shell --size 48 --out shell
explica thickness shell/labels.nii.gz --inner 1 --tissue 2 --layers 3 --out thickness)"},
      {"unfold",
       "a triangulated surface (GIFTI, FreeSurfer, VTK, PLY, OBJ, STL, OFF)",
       "the surface with a patch opened towards a viewpoint; what is seen, what it cost",
       {"center", "vertex", "radius", "label", "metric", "viewpoint", "direction", "surround",
        "target-visibility", "max-iterations", "max-time", "frames", "resume"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
explica unfold surfaces/pial.surf.gii --center 0,0,12 --radius 8 --direction 0,0,1 --out unfolded)"},
      {"verify",
       "the record of a run",
       "which of its inputs and outputs are still what they were",
       {},
       R"(explica phantom shell --size 24 --out shell
explica verify shell/provenance.json)"},
      {"view",
       "surfaces, a volume with surfaces, or a folder of explica unfold",
       "a window, or a picture or film without a display",
       {"screenshot", "film", "map", "labels", "region", "views", "colours", "range", "slices",
        "width", "height"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica view cortex/white.surf.gii --views left --screenshot left.png)"},
  };
  return all;
}

const FirstHelp* firstHelpOf(std::string_view command) {
  const auto& all = allFirstHelp();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const FirstHelp& row) { return row.command == command; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace explica::app
