// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The one table of what each command shows at first.  A new command adds its row; a new option is
// named here only if most people need it, and then takes another one's place.

#include "FirstHelp.h"

#include <algorithm>

namespace explica::app {

namespace {

// What several examples begin with.
constexpr std::string_view kSurfaces = R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --out surfaces
)";
constexpr std::string_view kCortexSurfaces =
    R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica surface cortex/labels.nii.gz --white-label 3 --grey-label 2 --faces 2000 --out surfaces
)";
constexpr std::string_view kStudy = R"(explica phantom cortex --size 32 --spacing 2 --out cortex
echo '{"hemispheres": ["L"], "input": "cortex/labels.nii.gz", "subjects": ["01"]}' > study.json
)";

}  // namespace

const std::vector<FirstHelp>& allFirstHelp() {
  static const std::vector<FirstHelp> all = {
      {"bids",
       {"participant-label", "hemisphere", "steps", "template", "include", "model",
        "unfold-surface", "given-surfaces", "unfold.center", "unfold.direction", "unfold.radius"},
       R"(explica phantom cortex --size 32 --spacing 2 --out phantom
mkdir -p data/sub-01/anat
cp phantom/labels.nii.gz data/sub-01/anat/sub-01_dseg.nii.gz
echo '{"Name": "phantoms", "BIDSVersion": "1.8.0"}' > data/dataset_description.json
explica bids data derived participant --hemisphere L --steps thickness,surface --surface.faces 2000
explica bids data derived group)"},
      {"cifti",
       {"left", "right", "left-cortex", "right-cortex", "name", "seconds"},
       R"(explica cifti --left surfaces/thickness.shape.gii --right surfaces/thickness.shape.gii \
  --name thickness --out cifti)",
       kSurfaces},
      {"compare",
       {"label", "label-key", "pairs", "sources", "local-limit"},
       "explica compare surfaces/white.surf.gii surfaces/pial.surf.gii --out compared",
       kSurfaces},
      {"descriptors", {}, "explica descriptors --out descriptors"},
      {"embed",
       {"fit", "average", "combine", "label-key", "slice", "order", "max-iterations", "frames"},
       R"(explica phantom shell --size 32 --out shell
explica embed shell/labels.nii.gz --label-key 1 --order 8 --out fit)"},
      {"figure",
       {"views", "layout", "size", "colours", "range"},
       "explica figure surfaces/pial.surf.gii surfaces/thickness.shape.gii --size 800 --out figure",
       kCortexSurfaces},
      {"flatten",
       {"vertex", "radius", "label", "cuts", "cortex", "area-tolerance", "grid", "surfaces",
        "volumes", "to-volume", "map", "regions", "resume"},
       R"(explica unfold surfaces/pial.surf.gii --center 0,0,12 --radius 8 --direction 0,0,1 --surround none --out unfolded
explica flatten unfolded/unfolded.surf.gii --surfaces surfaces --volumes shell/level.nii.gz --out flat)",
       kSurfaces},
      {"glm",
       {"maps", "table", "person", "model", "contrast", "surface", "mask", "site", "permutations",
        "tfce", "threshold"},
       R"(printf 'participant_id,age,thickness\ns1,20,2.6\ns2,30,2.5\ns3,40,2.5\ns4,50,2.3\ns5,60,2.2\n' > people.csv
explica glm people.csv --model 'thickness ~ age' --permutations 100 --out glm)"},
      {"heart",
       {"image", "preset", "cavity", "wall", "rv", "phases", "rv-insertion"},
       R"(explica phantom ventricle --size 64 --spacing 2 --slice 8 --frames 2 --out beat
explica heart beat/frame-0000.nii.gz beat/frame-0001.nii.gz --out heart)"},
      {"history", {}, R"(explica phantom shell --size 24 --out shell
explica history shell/labels.nii.gz)"},
      {"inflate",
       {"target-seen", "frames", "resume", "repair"},
       "explica inflate surfaces/white.surf.gii --out inflated",
       kCortexSurfaces},
      {"longitudinal",
       {"hemisphere", "atlas", "template", "segment.template", "segment.stripped", "surface.faces"},
       R"(explica phantom cortex --size 48 --out first
explica phantom cortex --size 48 --seed 2 --out second
explica longitudinal first/t1.nii.gz second/t1.nii.gz --hemisphere L --out change --dry-run)"},
      {"parcellate",
       {"atlas", "template", "hemisphere", "volume", "like", "ribbon"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --atlas shell/labels.nii.gz \
  --out surfaces
cp surfaces/white.surf.gii surfaces/sphere.reg.surf.gii
explica parcellate surfaces --atlas surfaces/regions.label.gii --hemisphere L --out regions)"},
      {"phantom cortex",
       {"size", "spacing", "thickness", "depth", "waves", "noise"},
       "explica phantom cortex --size 48 --out cortex"},
      {"phantom eccentric", {}, "explica phantom eccentric --size 64 --spacing 2 --out eccentric"},
      {"phantom folds", {}, R"(explica phantom folds --edge 2 --out folds
explica unfold folds/folds.surf.gii --label folds/region.label.gii --direction 0,0,1 --out open)"},
      {"phantom polygon19", {}, R"(explica phantom polygon19 --out p19
explica polygon p19/polygon.csv --region 0:19 --viewpoint 50.5,4000 --out open)"},
      {"phantom polygon34", {}, R"(explica phantom polygon34 --out p34
explica polygon p34/polygon.csv --region 0:34 --viewpoint 80.9,4000 --out open)"},
      {"phantom shell", {}, R"(explica phantom shell --size 48 --out shell
explica thickness shell/labels.nii.gz --inner 1 --tissue 2 --out thickness)"},
      {"phantom spheroid", {}, "explica phantom spheroid --size 64 --spacing 2 --out spheroid"},
      {"phantom ventricle", {}, "explica phantom ventricle --size 64 --spacing 2 --out ventricle"},
      {"polygon",
       {"region", "viewpoint", "direction", "label-key", "slice", "phantom", "surround", "method",
        "target-visibility", "max-iterations", "frames", "resume"},
       R"(explica phantom polygon34 --out p34
explica polygon p34/polygon.csv --region 0:34 --viewpoint 80.9,4000 --out flat)"},
      {"regions",
       {"atlas", "map", "hemisphere", "person"},
       R"(explica phantom shell --size 32 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 2000 --atlas shell/labels.nii.gz \
  --out surfaces
explica regions surfaces --atlas surfaces/regions.label.gii --hemisphere L --out tables)"},
      {"register",
       {"template", "to", "sulc", "curvature", "surfaces", "mirror", "smoothness", "max-areal"},
       R"(explica sphere surfaces/white.surf.gii --out sphere
explica register sphere/sphere.surf.gii --surfaces surfaces --to sphere/sphere.surf.gii \
  --to-sulc surfaces/sulc.shape.gii --to-curvature surfaces/curvature.shape.gii --out registered)",
       kCortexSurfaces},
      {"repair",
       {"max-move"},
       "explica repair surfaces/white.surf.gii surfaces/pial.surf.gii --out repaired",
       kSurfaces},
      {"replay", {}, R"(explica phantom shell --size 24 --out shell
explica replay shell/provenance.json --out again)"},
      {"report", {}, R"(explica phantom shell --size 32 --out shell
explica thickness shell/labels.nii.gz --inner 1 --tissue 2 --out thickness
explica report thickness)"},
      {"resample",
       {"from", "to", "template", "space", "method", "areas", "amounts"},
       R"(explica resample surfaces/thickness.shape.gii --from surfaces/white.surf.gii --to fsaverage3 \
  --out on-fsaverage3)",
       kSurfaces},
      {"run",
       {"atlas", "template", "kind", "hemisphere", "unfold-surface", "given-surfaces", "steps",
        "resume", "unfold.center", "unfold.direction", "unfold.radius"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica run cortex/labels.nii.gz --surface.faces 2000 --unfold.max-iterations 5 --out result \
  || [ $? -eq 3 ])"},
      {"sample",
       {"surfaces", "hemisphere", "white", "pial", "thickness", "depths", "depth-kind", "across",
        "interpolate", "to-volume", "mask", "labels", "points"},
       "explica sample shell/harmonic.nii.gz --surfaces surfaces --depths 5 --out sampled",
       kSurfaces},
      {"segment",
       {"mask", "atlas", "hemisphere", "smooth", "bias-width", "max-iterations"},
       R"(explica phantom cortex --size 48 --out cortex
explica segment cortex/t1.nii.gz --out tissue)"},
      {"smooth",
       {"surface", "fwhm", "mask"},
       "explica smooth surfaces/thickness.shape.gii --surface surfaces/mid.surf.gii --fwhm 5 --out "
       "smooth",
       kSurfaces},
      {"sphere",
       {"balance", "tolerance", "max-iterations"},
       "explica sphere surfaces/white.surf.gii --out sphere",
       kCortexSurfaces},
      {"study check", {}, "explica study check study.json", kStudy},
      {"study group",
       {"include", "model", "fwhm"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
echo '{"hemispheres": ["L"], "input": "cortex/labels.nii.gz", "subjects": ["01"],
  "parameters": {"steps": ["thickness"]}}' > study.json
explica study participant study.json results
explica study group study.json results)"},
      {"study hearts",
       {"participant-label", "endings", "preset", "phases"},
       R"(explica phantom ventricle --size 64 --spacing 2 --slice 8 --frames 2 --out beat
mkdir -p data/sub-01
cp beat/frame-0000.nii.gz data/sub-01/sub-01_frame-ED_dseg.nii.gz
cp beat/frame-0001.nii.gz data/sub-01/sub-01_frame-ES_dseg.nii.gz
explica study hearts data hearts)"},
      {"study list", {}, "explica study list study.json", kStudy},
      {"study participant", {}, R"(explica phantom cortex --size 32 --spacing 2 --out cortex
echo '{"hemispheres": ["L"], "input": "cortex/labels.nii.gz", "subjects": ["01"],
  "parameters": {"steps": ["thickness"]}}' > study.json
explica study participant study.json results)"},
      {"study schema", {}, "explica study schema > study.schema.json"},
      {"surface",
       {"preset", "white-label", "grey-label", "fill", "hemisphere", "genus", "faces",
        "inner-level", "outer-level", "atlas", "white-surface", "pial-surface", "freesurfer"},
       R"(explica phantom shell --size 48 --out shell
explica surface shell/labels.nii.gz --white-label 1 --grey-label 2 --faces 4000 --out surfaces)"},
      {"template",
       {"density", "iterations"},
       R"(explica phantom cortex --size 32 --spacing 2 --out cortex
explica phantom cortex --size 36 --spacing 2 --out other
for one in cortex other; do
  explica run $one/labels.nii.gz --hemisphere L --steps surface,sphere --surface.faces 2000 --out run-$one
done
explica template run-cortex run-other --density fsaverage3 --level 3 --out template || [ $? -eq 3 ])"},
      {"thickness",
       {"inner", "tissue", "outer", "insulated", "inner-level", "outer-level", "boundary", "method",
        "layers", "layer-kind", "sulci", "per-slice"},
       R"(explica phantom shell --size 48 --out shell
explica thickness shell/labels.nii.gz --inner 1 --tissue 2 --layers 3 --out thickness)"},
      {"unfold",
       {"center", "vertex", "radius", "label", "metric", "viewpoint", "direction", "surround",
        "target-visibility", "max-iterations", "frames", "resume"},
       "explica unfold surfaces/pial.surf.gii --center 0,0,12 --radius 8 --direction 0,0,1 --out "
       "unfolded",
       kSurfaces},
      {"verify", {}, R"(explica phantom shell --size 24 --out shell
explica verify shell/provenance.json)"},
      {"view",
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
