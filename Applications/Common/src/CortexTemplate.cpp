// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/CortexTemplate.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/Execute.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Provenance/Software.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

const fs::path kColin27Brain = "/usr/share/mricron/templates/ch2bet.nii.gz";
const fs::path kColin27Atlas = "/usr/share/mricron/templates/aal.nii.gz";

fs::path cacheFolder() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value == nullptr ? "" : value);
  };
  if (const fs::path own = set("EXPLICA_CACHE"); !own.empty()) return own;
  if (const fs::path all = set("XDG_CACHE_HOME"); !all.empty()) return all / "explica";
  if (const fs::path home = set("HOME"); !home.empty()) return home / ".cache/explica";
  throw EnvironmentError(
      "there is no place to keep the template made from Colin27; name one in EXPLICA_CACHE");
}

/// Makes the template beside its place and moves it there whole, so that several processes may.
/// @param structure  of who asks: another thread may ask for the other one's
fs::path colin27(Context& context, const std::string& structure) {
  const fs::path place = cacheFolder() / ("colin27-" + std::string(provenance::software().version));
  if (isThere(place / provenance::kRecordName)) return place;
  if (!hasTemplate(kDefaultTemplate)) {
    throw InvalidInput(
        "template colin27: '" + kColin27Brain.string() +
        "' is not there; install the package mricron-data, or name another template (--template)");
  }
  auto step = context.step("template");
  context.info("the template is made from Colin27, once, in " + place.string());
  const fs::path making = place.string() + "-" + std::to_string(getpid()) + structure;
  std::error_code fault;
  fs::create_directories(place.parent_path(), fault);
  if (fault) {
    throw EnvironmentError("'" + place.parent_path().string() + "': " + fault.message() +
                           "; name a place for the template in EXPLICA_CACHE");
  }
  const Json values = {{"INPUT", kColin27Brain.string()},
                       {"atlas", kColin27Atlas.string()},
                       {"steps", {"segment", "surface", "sphere"}}};
  try {
    context.runApart(*findCommand("run"), making, values);
    checkpoint(context.monitor());
    fs::rename(making, place, fault);  // fails where another process was faster
  } catch (...) {
    fs::remove_all(making, fault);
    throw;
  }
  fs::remove_all(making, fault);
  return place;
}

fs::path folderOf(Context& context, const std::string& name, const std::string& structure) {
  if (isFolder(name)) return name;
  const char* subjects = std::getenv("SUBJECTS_DIR");
  if (subjects != nullptr && isFolder(fs::path(subjects) / name)) return fs::path(subjects) / name;
  if (name == kDefaultTemplate) return colin27(context, structure);
  throw InvalidInput("template '" + name +
                     "': neither a folder nor a subject in $SUBJECTS_DIR; name a folder with "
                     "lh.sphere.reg, lh.sulc and lh.curv");
}

}  // namespace

std::optional<std::string> findFile(const std::vector<std::string>& folders,
                                    const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    for (const fs::path folder : folders) {
      if (fs::is_regular_file(folder / name)) return (folder / name).string();
    }
  }
  return {};
}

std::vector<std::string> withRegistration(const std::string& folder) {
  const fs::path surfaces = (fs::absolute(folder) / "").lexically_normal().parent_path();
  const std::string name = surfaces.filename().string(), step = "surface";
  std::vector<std::string> folders = {folder};
  if (name.starts_with(step)) {
    folders.push_back((surfaces.parent_path() / ("register" + name.substr(step.size()))).string());
  }
  return folders;
}

bool hasTemplate(const std::string& name) {
  return name != kDefaultTemplate || (isThere(kColin27Brain) && isThere(kColin27Atlas));
}

CortexTemplate findTemplate(Context& context, const std::string& name,
                            const std::string& structure) {
  const fs::path folder = folderOf(context, name, structure);
  const std::string side = structure == "CortexRight" ? "R" : "L";
  std::vector<std::string> folders;
  for (const std::string& below : {std::string(), std::string("surf"), std::string("label"),
                                   "surface-" + side, "sphere-" + side}) {
    folders.push_back((folder / below).string());
  }
  const auto find = [&](const std::string& freeSurfer, std::vector<std::string> others) {
    others.insert(others.begin(), (side == "R" ? "rh." : "lh.") + freeSurfer);
    others.insert(others.begin() + 1, "hemi-" + side + "_" + others.back());
    return findFile(folders, others);
  };
  const auto demand = [&](const std::string& freeSurfer, const std::vector<std::string>& others) {
    if (auto found = find(freeSurfer, others)) return *found;
    throw InvalidInput("template '" + folder.string() + "': no " + (side == "R" ? "rh." : "lh.") +
                       freeSurfer + " in it");
  };
  CortexTemplate files;
  // The 164k sphere as Human Connectome Project's pipelines distribute it.
  files.sphere = demand(
      "sphere.reg",
      {"fsaverage_std_sphere." + side + ".164k_fsavg_" + side + ".surf.gii", "sphere.surf.gii"});
  files.sulc = demand("sulc", {"sulc.shape.gii"});
  files.curvature = demand("curv", {"curvature.shape.gii"});
  files.sulcSd = find("sulc_sd", {"sulc_sd.shape.gii"}).value_or("");
  files.curvatureSd = find("curv_sd", {"curvature_sd.shape.gii"}).value_or("");
  files.atlas = find("aparc.annot", {"regions.label.gii"}).value_or("");
  files.white = find("white", {"white.surf.gii"}).value_or("");
  files.cuts = find("cuts.label.gii", {"cuts.label.gii"}).value_or("");
  files.pial = find("pial", {"pial.surf.gii"}).value_or("");
  return files;
}

}  // namespace explica::app
