// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Text.h"
#include "Explica/Study/StudyTable.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace explica::study {

/// A person, or one session, of a folder of hearts.
struct HeartSubject {
  std::string name;                           ///< "sub-01", "sub-01_ses-02", "patient001"
  std::filesystem::path folder;               ///< where the results go, below the study
  std::vector<std::filesystem::path> labels;  ///< label volumes, frames in the order of names
};

/// Where the label volumes of a person lie.
struct HeartLayout {
  /// Endings of file names, before .nii or .nii.gz: BIDS's, ACDC's, M&Ms's, Sunnybrook's.
  std::vector<std::string> endings = {"_dseg", "_gt", "_label", "_seg"};
};

/// The people of a folder, one entry a session, in the order of their names.
///
/// Every folder right below `dataset` that holds label volumes is a person, but for BIDS's code,
/// derivatives and sourcedata.  Folders `ses-*` in it are sessions.  Label volumes may lie deeper
/// (anat, cmr); with the first of the endings that any file has, other files are left aside.
///
/// @param wanted  people, with or without "sub-"; empty: all
/// @throws InvalidInput  no folder, nobody in it, or somebody wanted is absent
[[nodiscard]] std::vector<HeartSubject> findHearts(const std::filesystem::path& dataset,
                                                   const std::vector<std::string>& wanted = {},
                                                   const HeartLayout& layout = {});

/// One row a person, whatever became of the run in `out`/`folder`/heart: what participants.tsv
/// says, how the run went, the heart's numbers and its bull's-eye, if there is one, as its picture.
/// @param about  rows of participants.tsv by participant_id
[[nodiscard]] std::vector<StudyRow> heartRows(const std::filesystem::path& out,
                                              const std::vector<HeartSubject>& subjects,
                                              const std::map<std::string, TableRow>& about = {});

/// participants.tsv of a data set by participant_id; empty if it has none.
/// @throws InvalidInput  without a column participant_id
[[nodiscard]] std::map<std::string, TableRow> aboutParticipants(
    const std::filesystem::path& dataset);

/// Tab-separated, "n/a" where a row has no value; columns in a fixed order, segments last.
[[nodiscard]] std::string heartTable(const std::vector<StudyRow>& rows);

/// What each column of heartTable() means, with its unit, as BIDS wants it beside a table.
[[nodiscard]] std::string heartColumns(const std::vector<StudyRow>& rows);

/// A page of the table with each person's bull's-eye; no request but for these pictures.
[[nodiscard]] std::string heartPage(const std::vector<StudyRow>& rows, const std::string& title);

}  // namespace explica::study
