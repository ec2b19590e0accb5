// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Report/Page.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::pipeline {

struct FolderReportOptions {
  report::SideConvention convention = report::SideConvention::Neurological;
  int slices = 7;  ///< in each direction, in [1, 30]
  /// Files of vertex data to show on every surface that they fit; not described below, for they
  /// are inputs.
  std::vector<std::string> maps = {};
};

template <class Visitor>
void describe(FolderReportOptions& options, Visitor&& visit) {
  visit(Field{"convention", "",
              "slices with the person's left on the left (neurological) or on the right"},
        options.convention);
  visit(Field{"slices", "", "slices in each direction", 1, 30}, options.slices);
}

/// What a report on an output folder shows: of a whole run, or of one command.
///
/// Reads the records and summaries of the folder and of its step folders, and of the files that it
/// recognises what pictures, curves and the evolution need.  A file that is missing or cannot be
/// read leaves its picture out, with a warning and a flag; it never stops the report.
/// @throws InvalidInput  no command has written the folder, or an option is out of range
[[nodiscard]] report::ReportContent collectReport(const std::filesystem::path& folder,
                                                  const FolderReportOptions& options = {},
                                                  const Monitor& monitor = {});

/// A small picture that tells one result from another at a glance: the opened patch, else the
/// thickness from a side; none where a report shows neither.
[[nodiscard]] std::optional<report::Picture> thumbnailOf(const report::ReportContent& content);

}  // namespace explica::pipeline
