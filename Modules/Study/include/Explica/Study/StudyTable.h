// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace explica::study {

/// One row of the study table: a participant's hemisphere and its numbers by column.
struct StudyRow {
  std::string participant;                    ///< "sub-01" or "sub-01_ses-02"
  std::string hemisphere;                     ///< "L" or "R"
  std::string state;                          ///< "done", "stopped early", "failed: ..."
  std::filesystem::path report;               ///< report.html, relative to the study; may be absent
  std::map<std::string, std::string> values;  ///< "surface.euler_characteristic" and so on
};

/// Rows of all runs below `out/runs`, in the order of their names, whatever became of them.
[[nodiscard]] std::vector<StudyRow> collectRows(const std::filesystem::path& out);

/// Tab-separated, "n/a" where a row has no value (as BIDS wants it); columns in a fixed order.
[[nodiscard]] std::string tableText(const std::vector<StudyRow>& rows);

/// A page with the same table: columns sort on a click, failures and unmet goals are marked, rows
/// lead to their reports.  One file, no request.
[[nodiscard]] std::string indexPage(const std::vector<StudyRow>& rows, const std::string& title);

}  // namespace explica::study
