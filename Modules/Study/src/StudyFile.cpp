// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/StudyFile.h"

#include "Explica/Core/Errors.h"

namespace explica::study {
namespace {

// 16 MiB, 32 deep.
constexpr provenance::DocumentLimits kStudyLimits = {std::size_t{16} << 20, 32, 300'000};

}  // namespace

StudyFile readStudyFile(const std::filesystem::path& path) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(path, fault)) {
    throw IOError(path.string() + ": no such file; a study file in YAML or JSON is needed");
  }
  return provenance::readDocument(path, kStudyLimits);
}

std::string placeIn(const StudyFile& file, const std::vector<std::string>& place) {
  std::string pointer, dotted;
  int line = 0;
  for (const std::string& part : place) {
    pointer += "/" + part;
    dotted += (dotted.empty() ? "" : ".") + part;
    if (const auto found = file.lines.find(pointer); found != file.lines.end()) {
      line = found->second;
    }
  }
  return file.path.string() + (line > 0 ? ", line " + std::to_string(line) : "") +
         (dotted.empty() ? "" : ", " + dotted) + ": ";
}

}  // namespace explica::study
