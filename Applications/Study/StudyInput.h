// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/StudyPlan.h"

#include <string>

namespace explica::app {

/// JSON schema of study files, its options taken from the declarations of `run` and `unfold`.
[[nodiscard]] provenance::Json studyFileSchema();

/// Options of `explica run` that hold paths.
[[nodiscard]] study::PathOptions studyPathOptions();

/// Reads and checks a study file.
/// @throws IOError, InvalidInput  one sentence: file, line, place, remedy
[[nodiscard]] study::StudyFile readCheckedStudy(const std::string& path);

}  // namespace explica::app
