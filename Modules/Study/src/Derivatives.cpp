// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/Derivatives.h"

#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Export.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Study/SubjectFiles.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

/// An output of a run, and what it is called in BIDS.
struct Export {
  std::string step;
  std::string file;
  std::string suffix;  ///< after "sub-01_hemi-L"; '@' stands for the hemisphere
  std::string units;   ///< empty if none
  std::string description;
  bool ofPerson = false;   ///< the name has no hemisphere
  std::string space = {};  ///< of a template; empty: the person's own
};

// Names as sMRIPrep's: volumes of a person, surfaces and maps of a hemisphere.
const std::vector<Export> kExports = {
    {"segment", "brain_mask.nii.gz", "_desc-brain_mask.nii.gz", "", "brain", true},
    {"segment", "seg.nii.gz", "_dseg.nii.gz", "", "1 CSF, 2 grey matter, 3 white matter", true},
    {"segment", "gm.nii.gz", "_label-GM_probseg.nii.gz", "", "grey matter", true},
    {"segment", "wm.nii.gz", "_label-WM_probseg.nii.gz", "", "white matter", true},
    {"segment", "csf.nii.gz", "_label-CSF_probseg.nii.gz", "", "cerebrospinal fluid", true},
    {"segment", "to_template.h5", "_from-T1w_to-template_mode-image_xfm.h5", "mm",
     "ITK transform from points of the T1 to the template's", true},
    {"surface", "white.surf.gii", "_white.surf.gii", "mm", "white surface"},
    {"surface", "mid.surf.gii", "_midthickness.surf.gii", "mm", "surface at half depth"},
    {"surface", "pial.surf.gii", "_pial.surf.gii", "mm", "outer surface"},
    {"surface", "thickness.shape.gii", "_thickness.shape.gii", "mm",
     "cortical thickness; 0 where there is no grey matter"},
    {"surface", "curvature.shape.gii", "_curv.shape.gii", "mm^-1",
     "mean curvature of the white surface, positive in sulci"},
    {"surface", "sulc.shape.gii", "_sulc.shape.gii", "mm",
     "sulcal depth: distance travelled outwards as the white surface is inflated"},
    {"surface", "area.shape.gii", "_area.shape.gii", "mm^2",
     "area at each vertex of the white, middle and outer surface"},
    {"surface", "valid.shape.gii", "_desc-valid_mask.shape.gii", "",
     "1 where the thickness is defined"},
    {"surface", "doubt.shape.gii", "_desc-doubt_measure.shape.gii", "mm",
     "standard deviation of the white and of the outer border's place"},
    {"surface", "regions.label.gii", "_desc-regions_dseg.label.gii", "", "cortical regions"},
    {"surface", "regions.tsv", "_desc-regions_morph.tsv", "",
     "area and thickness of each cortical region"},
    {"surface", "topology.tsv", "_defects.tsv", "", "one row for each corrected defect"},
    {"sphere", "sphere.surf.gii", "_sphere.surf.gii", "mm", "white surface on a sphere"},
    {"register", "sphere.reg.surf.gii", "_desc-reg_sphere.surf.gii", "mm",
     "that sphere in register with the template's"},
    {"parcellate", "regions.label.gii", "_desc-template_dseg.label.gii", "",
     "the template's regions"},
    {"regions", "regions.tsv", "_desc-template_morph.tsv", "",
     "area, volume, thickness and curvature of each of the template's regions"},
    {"unfold", "unfolded.surf.gii", "_desc-unfold_midthickness.surf.gii", "mm",
     "patch unfolded for a viewpoint"},
    {"unfold", "region.label.gii", "_desc-unfold_roi.label.gii", "", "1 in the unfolded patch"},
    {"unfold", "visibility.shape.gii", "_desc-visibility_measure.shape.gii", "",
     "flux and visible share of each vertex, before and after"},
    {"unfold", "distortion.shape.gii", "_desc-distortion_measure.shape.gii", "",
     "area ratio, angle change in degrees, edge strain"},
    {"thickness", "thickness.nii.gz", "_desc-harmonic_thickness.nii.gz", "mm",
     "length of the trajectory through each voxel"},
    {"thickness", "layers.nii.gz", "_desc-layers@_dseg.nii.gz", "",
     "layers, counted from the white matter", true},
};

/// Whether the BIDS schema has names such as an export's; surfaces and maps are not yet in it.
bool isInSchema(const Export& item) {
  constexpr std::array kEndings = {"_dseg.nii.gz", "_dseg.label.gii", "_mask.nii.gz",
                                   "_probseg.nii.gz"};
  return std::ranges::any_of(kEndings,
                             [&](const char* ending) { return item.suffix.ends_with(ending); });
}

/// What a validator passes over: each kind of file that the schema lacks, by name.
std::string ignoredText() {
  std::set<std::string> lines;
  for (const Export& item : kExports) {
    if (!isInSchema(item)) lines.insert("*" + item.suffix.substr(0, item.suffix.find('.')) + ".*");
  }
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text +
         "sub-*.html\ndescriptions.tsv\nruns/\nratings/\ngroup/\nprov/\nstudy*.tsv\nindex.html\n"
         "summary.json\nprovenance.json\n";
}

constexpr const char* kReadMe =
    "# Cortical surfaces, thickness and unfolded patches\n\n"
    "Made by Explica (`explica bids`). `sub-XX.html` leads to the reports on a person, "
    "`index.html` (after the group level) to those on all. In `sub-XX/anat`: tissues and brain "
    "mask of the T1; of each hemisphere white, middle and pial surface, thickness, sulcal depth, "
    "curvature and areas at their vertices, and the same at the vertices of a template; an "
    "unfolded patch. Each file has a sidecar with its sources, unit and SHA-256. "
    "`descriptions.tsv` says what each `desc-` means. `runs` holds every run with its records. "
    "Surfaces and maps have names as sMRIPrep's, which the BIDS schema does not contain yet: "
    "`.bidsignore` lists these kinds of file.\n";

/// The fixed ones, and maps on the template: "thickness_space-X_den-Y.shape.gii" becomes
/// "_space-X_den-Y_thickness.shape.gii".
std::vector<Export> exportsOf(const fs::path& run) {
  constexpr std::string_view kSpace = "_space-", kDensity = "_den-", kEnding = ".shape.gii";
  std::vector<Export> all = kExports;
  for (const fs::path& file : entriesOf(run / "resample")) {
    const std::string name = file.filename().string();
    const std::size_t at = name.find(kSpace), density = name.find(kDensity);
    if (at == std::string::npos || density == std::string::npos || !name.ends_with(kEnding)) {
      continue;
    }
    const std::string measure = name.substr(0, at);
    const std::string entity = name.substr(at, name.size() - at - kEnding.size());
    const std::size_t begin = at + kSpace.size();
    all.push_back({"resample", name, entity + "_" + measure + std::string(kEnding),
                   measure == "area" ? "mm^2" : "mm", measure + " at the template's vertices",
                   false, name.substr(begin, density - begin)});
  }
  return all;
}

/// Writes unless the file holds the same already: names and dates of unchanged files stay.
void writeIfDifferent(const fs::path& path, const std::string& text) {
  if (isThere(path) && fileText(path) == text) return;
  writeTextFile(path, text);
}

std::string withoutExtensions(const std::string& name) {
  const std::size_t last = name.find_last_of('_');
  return name.substr(0, name.find('.', last == std::string::npos ? 0 : last));
}

fs::path anatOf(const Participant& participant) {
  fs::path folder = "sub-" + participant.label;
  if (participant.session) folder /= "ses-" + *participant.session;
  return folder / "anat";
}

/// Whether both hemispheres' runs have the same file.
bool isShared(const Export& item) {
  return item.ofPerson && item.suffix.find('@') == std::string::npos;
}

/// An export's path in the derivative.
std::string nameIn(const Participant& participant, const std::string& hemisphere,
                   const Export& item) {
  std::string name =
      participant.name() + (item.ofPerson ? "" : "_hemi-" + hemisphere) + item.suffix;
  const std::size_t side = name.find('@');
  if (side != std::string::npos) name.replace(side, 1, hemisphere);
  return (anatOf(participant) / name).generic_string();
}

/// Everything in a subject's folder that a step may have read.
std::vector<fs::path> filesOf(const fs::path& input) {
  std::vector<fs::path> all;
  if (!isFolder(input)) return {input};
  const SubjectFiles files = findSubjectFiles(input);
  for (const auto& file : {files.labels, files.t1, files.mask, files.atlas, files.surfaceVolume}) {
    if (file) all.push_back(*file);
  }
  for (const HemisphereFiles& side : {files.left, files.right}) {
    for (const auto& file : {side.white, side.pial, side.mid, side.parcellation}) {
      if (file) all.push_back(*file);
    }
  }
  return all;
}

/// Finds what the outputs of one run were made from.
class Sources {
 public:
  Sources(const fs::path& run, const Participant& participant, const std::string& hemisphere,
          const DerivativeOrigin& origin)
      : run_(run), origin_(origin), inputs_(filesOf(participant.input)) {
    for (const Export& item : exportsOf(run)) {
      exported_[item.step + "/" + item.file] = "bids::" + nameIn(participant, hemisphere, item);
    }
    for (const char* step : kRunSteps) {
      const fs::path record = run_ / step / provenance::kRecordName;
      if (isThere(record)) records_[step] = provenance::readRecord(record);
    }
  }

  /// URIs of what a step read: other exports, and files of the data set.
  [[nodiscard]] Json of(const std::string& step) const {
    std::set<std::string> uris;
    collect(step, uris);
    return Json(uris);
  }

  /// The file whose space the step's outputs are in.
  [[nodiscard]] std::string space() const {
    for (const char* step : {"segment", "thickness", "surface"}) {
      const auto record = records_.find(step);
      if (record == records_.end()) continue;
      for (const char* role : {"T1", "SEG", "fs-volume"}) {
        for (const Json& input : record->second["inputs"]) {
          if (input["role"] != role) continue;
          if (const auto uri = uriOf(input["name"])) return *uri;
        }
      }
    }
    return "orig";
  }

  /// The activity that a step's record tells of, as prov/ names it; empty without a record.
  [[nodiscard]] std::string activity(const std::string& step) const {
    const auto record = records_.find(step);
    if (record == records_.end()) return "";
    return provenance::activityName(record->second);
  }

 private:
  void collect(const std::string& step, std::set<std::string>& uris) const {
    const auto record = records_.find(step);
    if (record == records_.end()) return;
    for (const Json& input : record->second["inputs"]) {
      const std::string name = input["name"];
      if (const auto uri = uriOf(name)) {
        uris.insert(*uri);
        continue;
      }
      for (const auto& [other, made] : records_) {
        if (other == step || !isThere(run_ / other / name)) continue;
        const auto exported = exported_.find(other + "/" + name);
        if (exported != exported_.end()) {
          uris.insert(exported->second);
        } else {
          collect(other, uris);
        }
      }
    }
  }

  /// A file of the subject, by its name.
  [[nodiscard]] std::optional<std::string> uriOf(const std::string& name) const {
    for (const fs::path& file : inputs_) {
      if (file.filename() != name) continue;
      const fs::path inside = file.lexically_relative(origin_.dataset);
      if (!inside.empty() && *inside.begin() != "..") return "bids:raw:" + inside.generic_string();
      return (origin_.withNames ? "file://" + fs::absolute(file).string() : name);
    }
    return std::nullopt;
  }

  fs::path run_;
  const DerivativeOrigin& origin_;
  std::vector<fs::path> inputs_;
  std::map<std::string, std::string> exported_;  ///< STEP/FILE to its URI
  std::map<std::string, Json> records_;          ///< by step
};

/// What the columns of a run's table mean.
struct TableColumn {
  const char *step, *file, *name, *meaning, *units;
};
constexpr TableColumn kTableColumns[] = {
    {"regions", "regions.tsv", "person", "the row's person", ""},
    {"regions", "regions.tsv", "hemisphere", "the row's hemisphere", ""},
    {"regions", "regions.tsv", "atlas", "the row's atlas", ""},
    {"regions", "regions.tsv", "region", "the row's region", ""},
    {"regions", "regions.tsv", "measure", "the row's measure", ""},
    {"regions", "regions.tsv", "unit", "the row's unit", ""},
    {"regions", "regions.tsv", "value", "of the measure in the region, in the row's unit", ""},
    {"surface", "regions.tsv", "index", "label of the region", ""},
    {"surface", "regions.tsv", "name", "its name", ""},
    {"surface", "regions.tsv", "vertices", "vertices in it", ""},
    {"surface", "regions.tsv", "area_white_mm2", "area of the white surface", "mm^2"},
    {"surface", "regions.tsv", "volume_mm3", "volume between white and pial surface", "mm^3"},
    {"surface", "regions.tsv", "thickness_mean_mm",
     "mean thickness, weighted by area, where there is grey matter", "mm"},
    {"surface", "regions.tsv", "thickness_sd_mm", "its standard deviation", "mm"},
    {"surface", "regions.tsv", "thickness_nearest_mean_mm",
     "mean of FreeSurfer's thickness: nearest distances, both ways", "mm"},
    {"surface", "regions.tsv", "doubtful_share",
     "share of the area where the image leaves a border more than half a voxel", ""},
    {"surface", "topology.tsv", "kind", "island, cavity, handle or tunnel", ""},
    {"surface", "topology.tsv", "x_mm", "place of the defect, RAS", "mm"},
    {"surface", "topology.tsv", "y_mm", "place of the defect, RAS", "mm"},
    {"surface", "topology.tsv", "z_mm", "place of the defect, RAS", "mm"},
    {"surface", "topology.tsv", "voxels", "voxels changed", ""},
    {"surface", "topology.tsv", "cost", "evidence overruled by the correction", ""},
    {"surface", "topology.tsv", "alternative_cost", "evidence that the other way would overrule",
     ""},
    {"surface", "topology.tsv", "side", "filled or removed", ""},
    {"surface", "topology.tsv", "why", "reason for the choice", ""}};

}  // namespace

void describeDerivatives(const fs::path& out, const DerivativeOrigin& origin,
                         const std::string& version) {
  fs::create_directories(out);
  // A link that moves with the two folders; without names only the last folder's.
  const fs::path source = fs::weakly_canonical(origin.dataset);
  const std::string link = origin.withNames
                               ? source.lexically_relative(fs::weakly_canonical(out)).string()
                               : source.filename().string();
  Json description = Json::object();
  description["Name"] = "Explica: cortical surfaces, thickness and unfolded patches";
  description["BIDSVersion"] = "1.8.0";
  description["DatasetType"] = "derivative";
  description["GeneratedBy"] = Json::array({Json{
      {"Name", "Explica"},
      {"Version", version},
      {"Description", "explica bids: thickness, surfaces and unfolding of each hemisphere"}}});
  description["SourceDatasets"] = Json::array({Json{{"URL", "bids:raw:."}}});
  description["DatasetLinks"] = Json{{"raw", link}};
  writeIfDifferent(out / "dataset_description.json", provenance::textOf(description, 2) + "\n");
  writeIfDifferent(out / "descriptions.tsv",
                   "desc_id\tdescription\n"
                   "unfold\tpatch unfolded for a viewpoint\n"
                   "visibility\tflux and visible share per vertex, before and after unfolding\n"
                   "distortion\tarea, angle and length changes of the unfolded patch\n"
                   "valid\twhere a measure is defined\n"
                   "regions\tcortical regions of the atlas that came with the input\n"
                   "template\tcortical regions of the template, by registration\n"
                   "reg\tin register with the template\n"
                   "harmonic\talong trajectories of the harmonic interpolant\n"
                   "brain\twhat is brain\n"
                   "layersL\tlayers of the left cortex, counted from the white matter\n"
                   "layersR\tlayers of the right cortex, counted from the white matter\n");
  writeIfDifferent(out / ".bidsignore", ignoredText());
  writeIfDifferent(out / "README.md", kReadMe);
}

std::vector<fs::path> exportRun(const fs::path& run, const fs::path& out,
                                const Participant& participant, const std::string& hemisphere,
                                const DerivativeOrigin& origin) {
  std::vector<fs::path> written;
  const auto nameOf = [&](const Export& item) { return nameIn(participant, hemisphere, item); };
  const fs::path other =
      run.parent_path() / (participant.name() + "_hemi-" + (hemisphere == "L" ? "R" : "L"));
  const auto sidecarOf = [](const std::string& name) { return withoutExtensions(name) + ".json"; };
  const std::vector<Export> exports = exportsOf(run);
  std::vector<const Export*> items;
  for (const Export& item : exports) {
    if (isThere(run / item.step / item.file)) {
      items.push_back(&item);
    } else if (!isShared(item) || !isThere(other / item.step / item.file)) {
      fs::remove(out / sidecarOf(nameOf(item)));
      fs::remove(out / nameOf(item));
    }
  }
  if (items.empty()) return written;
  const Sources sources(run, participant, hemisphere, origin);
  fs::create_directories(out / anatOf(participant));
  Json surface = Json::object();
  if (isThere(run / "surface" / provenance::kSummaryName)) {
    surface = provenance::readJson(run / "surface" / provenance::kSummaryName);
  }
  for (const Export* listed : items) {
    const Export& item = *listed;
    const std::string name = nameOf(item);
    const std::string content = fileText(run / item.step / item.file);
    Json sidecar = Json::object();
    sidecar["Description"] = item.description;
    sidecar["Sources"] = sources.of(item.step);
    sidecar["SpatialReference"] = item.space.empty() ? sources.space() : item.space;
    if (!item.units.empty()) sidecar["Units"] = item.units;
    if (!isShared(item) && surface.contains("euler_characteristic")) {
      sidecar["EulerNumber"] = surface["euler_characteristic"];
      sidecar["NumberOfDefects"] = surface["defects_corrected"];
    }
    for (const TableColumn& column : kTableColumns) {
      if (item.step != column.step || item.file != column.file) continue;
      sidecar[column.name] = {{"Description", column.meaning}};
      if (*column.units != '\0') sidecar[column.name]["Units"] = column.units;
    }
    sidecar["Digest"] = {{"sha256", provenance::sha256Of(content)}};
    const std::string activity = sources.activity(item.step);
    if (!activity.empty()) sidecar["GeneratedBy"] = "bids::prov#" + activity;
    // The sidecar last: a file that has one is whole.
    writeIfDifferent(out / name, content);
    writeIfDifferent(out / sidecarOf(name), provenance::textOf(sidecar, 2) + "\n");
    written.emplace_back(name);
  }
  return written;
}

}  // namespace explica::study
