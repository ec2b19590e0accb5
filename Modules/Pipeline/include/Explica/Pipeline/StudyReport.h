// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
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

/// What a report on an output folder shows: of a whole run, or of one command.
///
/// Reads the records and summaries of the folder and of its step folders, and of the files that it
/// recognises what pictures, curves and the evolution need.  A file that is missing or cannot be
/// read leaves its picture out, with a warning and a flag; it never stops the report.
/// @throws InvalidInput  no record in the folder nor in a folder of it
[[nodiscard]] report::ReportContent collectReport(const std::filesystem::path& folder,
                                                  const Monitor& monitor = {});

}  // namespace explica::pipeline
