// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Digest.h"
#include "Explica/Testing/Command.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace explica::testing {

/// SHA-256 by name, as stableHashes() gives them.
using Hashes = std::map<std::string, std::string>;

/// Names of files that one has and the other has not, or with other content.
inline std::vector<std::string> differences(const Hashes& a, const Hashes& b) {
  std::vector<std::string> names;
  for (const auto& [name, hash] : a) {
    const auto other = b.find(name);
    if (other == b.end() || other->second != hash) names.push_back(name);
  }
  for (const auto& [name, hash] : b) {
    if (!a.count(name)) names.push_back(name);
  }
  return names;
}

/// Final files that are not what an undisturbed run writes; remains of the interruption (hidden
/// names) are no final files.
inline std::vector<std::string> damagedFiles(const std::filesystem::path& out,
                                             const Hashes& undisturbed) {
  namespace fs = std::filesystem;
  std::vector<std::string> damaged;
  if (!fs::exists(out)) return damaged;
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    const fs::path name = entry.path().lexically_relative(out);
    const auto hidden = [](const fs::path& part) { return part.string().rfind('.', 0) == 0; };
    if (!entry.is_regular_file() || std::any_of(name.begin(), name.end(), hidden)) continue;
    const auto whole = undisturbed.find(name.string());
    if (whole != undisturbed.end()) {
      if (provenance::digestOf(entry.path()).sha256 != whole->second) damaged.push_back(name);
    } else if (name.extension() == ".json") {
      try {
        (void)readJson(entry.path());
      } catch (const std::exception&) {
        damaged.push_back(name);
      }
    } else if (name.filename() == "report.html") {
      if (readText(entry.path()).find("</html>") == std::string::npos) damaged.push_back(name);
    }
  }
  return damaged;
}

}  // namespace explica::testing
