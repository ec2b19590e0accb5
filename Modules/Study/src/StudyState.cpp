// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/StudyState.h"

#include "Explica/Core/Folders.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Software.h"

#include <algorithm>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr std::size_t kKeyDigits = 16;  // 64 bits: two of a million subjects' keys agree by chance
                                        // once in ten million studies

/// The content of a file, or of a folder's files: those of a FreeSurfer subject that are data.
Json contentOf(const fs::path& path) {
  std::error_code fault;
  if (fs::is_regular_file(path, fault)) return provenance::digestOf(path).sha256;
  if (!isFolder(path)) return nullptr;
  Json files = Json::object();
  std::vector<fs::path> found;
  for (const char* part : {"mri", "surf", "label"}) {
    if (!isFolder(path / part)) continue;
    for (const auto& entry : fs::directory_iterator(path / part)) {
      if (entry.is_regular_file(fault)) found.push_back(entry.path());
    }
  }
  std::ranges::sort(found);
  for (const fs::path& file : found) {
    files[file.lexically_relative(path).generic_string()] = provenance::digestOf(file).sha256;
  }
  return files;
}

}  // namespace

std::string keyOf(const PlannedSubject& subject, const PathOptions& paths) {
  const auto& software = provenance::software();
  Json all = Json::object();
  all["software"] = {software.version, software.commit};
  all["input"] = contentOf(subject.participant.input);
  if (subject.participant.atlas) all["atlas"] = contentOf(*subject.participant.atlas);
  for (const PlannedRun& run : subject.runs) {
    Json values = run.values;
    for (auto& [key, value] : values.items()) {
      if (!paths.count(key)) continue;
      if (value.is_string()) value = contentOf(value.get<std::string>());
      if (!value.is_array()) continue;
      for (Json& one : value) one = contentOf(one.get<std::string>());
    }
    // Keys in the order of their names: how the study file orders them does not matter.
    all["runs"][run.folder] = nlohmann::json::parse(provenance::textOf(values));
  }
  return provenance::sha256Of(provenance::textOf(all)).substr(0, kKeyDigits);
}

fs::path stateFile(const fs::path& out, const PlannedSubject& subject, const std::string& key) {
  return out / "state" / (subject.participant.name() + "-" + key + ".json");
}

void unsettle(const fs::path& out, const PlannedSubject& subject) {
  const std::string begin = subject.participant.name() + "-";
  std::error_code fault;
  const auto isOurs = [&](const std::string& name) {
    return name.size() == begin.size() + kKeyDigits + 5 && name.starts_with(begin);
  };
  for (const fs::path& file : entriesOf(out / "state", isOurs)) fs::remove(file, fault);
}

void settle(const fs::path& out, const PlannedSubject& subject, const std::string& key) {
  Json state = Json::object();
  state["subject"] = subject.participant.name();
  state["key"] = key;
  state["runs"] = Json::array();
  for (const PlannedRun& run : subject.runs) state["runs"].push_back(run.folder);
  fs::create_directories(out / "state");
  writeTextFile(stateFile(out, subject, key), provenance::textOf(state, 2) + "\n");
}

}  // namespace explica::study
