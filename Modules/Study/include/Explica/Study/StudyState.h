// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/StudyPlan.h"

#include <filesystem>
#include <string>

namespace explica::study {

/// What a subject's results depend on, as 16 hexadecimal digits: the software's version and commit,
/// the options of its runs and the content of every file that these name.  Not: paths, dates, the
/// number of threads.  A file that is absent counts as absent.
[[nodiscard]] std::string keyOf(const PlannedSubject& subject, const PathOptions& paths);

/// The file that says that a subject's work is settled: it ended by itself with these inputs, and
/// doing it again could only give the same.  `OUT/state/sub-01-<key>.json`
[[nodiscard]] std::filesystem::path stateFile(const std::filesystem::path& out,
                                              const PlannedSubject& subject,
                                              const std::string& key);

/// Takes back what was settled of a subject with any key: it is about to be done.
void unsettle(const std::filesystem::path& out, const PlannedSubject& subject);

/// Writes the state file.
void settle(const std::filesystem::path& out, const PlannedSubject& subject,
            const std::string& key);

}  // namespace explica::study
