// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Page.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::pipeline {

/// Name of the file in which a run keeps how its steps went, beside the steps' folders.
inline constexpr const char* kRunStateName = "run.json";

/// How one step of a run went, as kept in run.json: what no step's own record can say.
struct StepNote {
  std::string name;  ///< folder of the step
  std::string command;
  report::StepState state = report::StepState::Missing;
  std::string message;  ///< of the error that ended it
};

void writeRunState(const std::filesystem::path& file, const std::vector<StepNote>& steps);
/// @return empty if the file is absent
[[nodiscard]] std::vector<StepNote> readRunState(const std::filesystem::path& file);

}  // namespace explica::pipeline
