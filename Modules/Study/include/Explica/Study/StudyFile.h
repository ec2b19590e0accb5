// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Json.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::study {

/// A study file as it stands on the disk, in YAML or JSON.
using StudyFile = provenance::Document;

/// @throws IOError       it cannot be read
/// @throws InvalidInput  a fault of syntax, or a key that is given twice: file, line and remedy
[[nodiscard]] StudyFile readStudyFile(const std::filesystem::path& path);

/// JSON schema (draft 7) of study files.
/// @param parameters  schemas of the options of `explica run`, by name: "surface.faces"
/// @param region      schemas of the options that place a patch and its viewpoint: "radius"
[[nodiscard]] provenance::Json studySchema(const provenance::Json& parameters,
                                           const provenance::Json& region);

/// @throws InvalidInput  the first fault, in one sentence: file, line, place and remedy
void checkStudyFile(const StudyFile& file, const provenance::Json& schema);

/// "FILE, line 12, subjects.02: ", to begin a sentence on a place in the file.
/// @param place  keys and indices from the root
[[nodiscard]] std::string placeIn(const StudyFile& file, const std::vector<std::string>& place);

}  // namespace explica::study
