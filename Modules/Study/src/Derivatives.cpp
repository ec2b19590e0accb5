// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/Derivatives.h"

#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Json.h"

#include <fstream>
#include <sstream>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

/// An output of a run, and what it is called in BIDS.
struct Export {
  const char* from;    ///< below the run's folder
  const char* suffix;  ///< after "sub-01_hemi-L"
  const char* units;   ///< empty if none
};

constexpr Export kExports[] = {
    {"surface/white.surf.gii", "_white.surf.gii", "mm"},
    {"surface/mid.surf.gii", "_midthickness.surf.gii", "mm"},
    {"surface/pial.surf.gii", "_pial.surf.gii", "mm"},
    {"surface/thickness.shape.gii", "_thickness.shape.gii", "mm"},
    {"surface/curvature.shape.gii", "_curv.shape.gii", "mm^-1"},
    {"surface/sulc.shape.gii", "_sulc.shape.gii", "mm"},
    {"unfold/unfolded.surf.gii", "_desc-unfold_midthickness.surf.gii", "mm"},
    {"unfold/region.label.gii", "_desc-unfold_roi.label.gii", ""},
    {"unfold/visibility.shape.gii", "_desc-visibility_dist.shape.gii", ""},
    {"unfold/distortion.shape.gii", "_desc-distortion_dist.shape.gii", ""},
    {"thickness/thickness.nii.gz", "_desc-harmonic_thickness.nii.gz", "mm"},
    {"thickness/layers.nii.gz", "_desc-layers_dseg.nii.gz", ""},
};

std::string readText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Writes unless the file holds the same already: names and dates of unchanged files stay.
void writeIfDifferent(const fs::path& path, const std::string& text) {
  if (fs::exists(path) && readText(path) == text) return;
  writeTextFile(path, text);
}

std::string withoutExtensions(const std::string& name) {
  const std::size_t last = name.find_last_of('_');
  return name.substr(0, name.find('.', last == std::string::npos ? 0 : last));
}

}  // namespace

void describeDerivatives(const fs::path& out, const fs::path& source, const std::string& version) {
  fs::create_directories(out);
  Json description = Json::object();
  description["Name"] = "Explica: cortical surfaces, thickness and unfolded patches";
  description["BIDSVersion"] = "1.8.0";
  description["DatasetType"] = "derivative";
  description["GeneratedBy"] = Json::array({Json{{"Name", "Explica"}, {"Version", version}}});
  description["SourceDatasets"] = Json::array({Json{{"URL", fs::absolute(source).string()}}});
  description["DatasetLinks"] = Json{{"raw", fs::absolute(source).string()}};
  writeIfDifferent(out / "dataset_description.json", description.dump(2) + "\n");
  writeIfDifferent(out / "descriptions.tsv",
                   "desc_id\tdescription\n"
                   "unfold\tpatch unfolded for a viewpoint\n"
                   "visibility\tflux and visible share per vertex, before and after unfolding\n"
                   "distortion\tarea, angle and length changes of the unfolded patch\n"
                   "harmonic\talong trajectories of the harmonic interpolant\n"
                   "layers\tlayers of the cortex, counted from the white matter\n");
  writeIfDifferent(out / ".bidsignore",
                   "*.surf.gii\n*.shape.gii\n*.label.gii\n*.json\nruns/\n*.html\n");
}

std::vector<fs::path> exportRun(const fs::path& run, const fs::path& out,
                                const Participant& participant, const std::string& hemisphere) {
  fs::path folder = fs::path("sub-" + participant.label);
  if (participant.session) folder /= "ses-" + *participant.session;
  folder /= "anat";
  fs::create_directories(out / folder);
  Json surface = Json::object();
  if (fs::exists(run / "surface" / "summary.json")) {
    surface = provenance::readJson(run / "surface" / "summary.json");
  }
  std::vector<fs::path> written;
  for (const Export& item : kExports) {
    const fs::path from = run / item.from;
    if (!fs::exists(from)) continue;
    const std::string name = participant.name() + "_hemi-" + hemisphere + item.suffix;
    writeIfDifferent(out / folder / name, readText(from));
    Json sidecar = Json::object();
    sidecar["Sources"] = Json::array({fs::absolute(participant.input).string(),
                                      "bids::" + fs::relative(from, out).generic_string()});
    sidecar["SpatialReference"] = "orig";
    if (*item.units) sidecar["Units"] = item.units;
    if (surface.contains("euler_characteristic")) {
      sidecar["EulerNumber"] = surface["euler_characteristic"];
      sidecar["NumberOfDefects"] = surface["defects_corrected"];
    }
    writeIfDifferent(out / folder / (withoutExtensions(name) + ".json"), sidecar.dump(2) + "\n");
    written.push_back(folder / name);
  }
  return written;
}

}  // namespace explica::study
