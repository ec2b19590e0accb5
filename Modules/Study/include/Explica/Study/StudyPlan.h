// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/BidsDataset.h"
#include "Explica/Study/StudyFile.h"

#include <set>
#include <string>
#include <vector>

namespace explica::study {

/// One use of `explica run` that a study asks for.
struct PlannedRun {
  std::string folder;       ///< "sub-01_hemi-L" or "sub-01_hemi-L_region-hand"
  std::string hemisphere;   ///< "L" or "R"
  std::string region;       ///< empty if the study names none
  provenance::Json values;  ///< options of the run, as in --config; paths resolved
};

struct PlannedSubject {
  Participant participant;
  std::vector<PlannedRun> runs;
};

/// What a study is made of, read and checked.
struct Study {
  std::string name;
  std::vector<PlannedSubject> subjects;  ///< in the order of the file
};

/// Names of the options that hold paths, as in "parameters" ("unfold.label").
using PathOptions = std::set<std::string>;

/// Labels of a study's subjects, without "sub-", in their order.
/// @throws InvalidInput  a subject given twice; no subjects and no data set
[[nodiscard]] std::vector<std::string> subjectsOf(const StudyFile& file);

/// Takes a checked file apart: for each subject the input, and for each hemisphere and region the
/// options of its run.  What a subject says wins over what all say; of options that exclude each
/// other (viewpoint, direction, ...; center, vertex, label) only the more particular one stays.
/// Regions in common coordinates c are taken to a subject's s by c = A s, A the subject's
/// "to-common": points by the inverse of A, directions by that of its linear part; lengths in mm
/// stay.  Relative paths start at the study file's folder.  An input that is not there becomes the
/// participant's problem, so that it stops nobody else.
/// @param labels  subjects wanted, with or without "sub-"; empty: all
/// @throws InvalidInput  names file, line and remedy
[[nodiscard]] Study planStudy(const StudyFile& file, const PathOptions& paths,
                              const std::vector<std::string>& labels = {});

}  // namespace explica::study
