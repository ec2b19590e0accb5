// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "KeptRun.h"

#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Study/Derivatives.h"
#include "Explica/Study/StudyTable.h"
#include "GroupParts.h"

#include <set>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr const char* kTogether = "maps_";  // begins the name of the file of all maps

/// "space-X_den-Y" of a file in the folder whose name begins so; empty if there is none.
std::string entityIn(const fs::path& folder, const std::string& begin) {
  const std::string end = ".shape.gii";
  const auto found = entriesOf(folder, [&](const std::string& name) {
    return name.starts_with(begin + "space-") && name.ends_with(end);
  });
  if (found.empty()) return "";
  const std::string name = found.front().filename().string();
  return name.substr(begin.size(), name.size() - begin.size() - end.size());
}

}  // namespace

TemplateMaps templateMapsOf(const fs::path& run) {
  TemplateMaps maps{entityIn(run / "resample", std::string(kMeasures[0]) + "_"), false};
  if (maps.entity.empty()) maps = {entityIn(run, kTogether), true};
  return maps;
}

bool isKept(const fs::path& run, const std::string& key) {
  const fs::path kept = run / study::kKeptName;
  return isThere(kept) && provenance::readJson(kept).value("key", "") == key;
}

void keepForGroup(const fs::path& run, const std::string& key) {
  const TemplateMaps maps = templateMapsOf(run);
  if (maps.entity.empty() || maps.together) return;
  std::vector<io::VertexMap> all;
  for (const char* measure : kMeasures) {
    all.push_back(
        io::readVertexMaps(run / "resample" / (measure + ("_" + maps.entity) + ".shape.gii"))
            .front());
    all.back().name = measure;
  }
  const std::string name = run.filename().string();
  const bool right = name.find("_hemi-R") != std::string::npos;
  const fs::path together = run / (kTogether + maps.entity + ".shape.gii");
  io::writeGiftiShape(together, all, right ? "CortexRight" : "CortexLeft");
  Json kept = study::accountOf(run);
  kept["key"] = key;
  kept["template"] =
      provenance::readRecord(run / "register" / provenance::kRecordName)["options"]["template"];
  provenance::writeJson(run / study::kKeptName, kept);
  const std::set<std::string> stays = {study::kKeptName, together.filename().string(),
                                       "report.html", provenance::kRecordName, "problem.txt"};
  for (const fs::path& path :
       entriesOf(run, [&](const std::string& entry) { return !stays.count(entry); })) {
    fs::remove_all(path);
  }
}

void shareSteps(const fs::path& made, const fs::path& run, bool sameHemisphere) {
  std::error_code fault;
  for (const std::string step : study::kRunSteps) {
    if (step == (sameHemisphere ? "unfold" : "thickness")) break;
    if (!isThere(made / step / provenance::kRecordName) || isThere(run / step)) continue;
    fs::create_directories(run, fault);
    fs::copy(made / step, run / step,
             fs::copy_options::recursive | fs::copy_options::create_hard_links, fault);
    if (fault) fs::remove_all(run / step, fault);  // no such links here
  }
}

}  // namespace explica::app
