// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Json.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace explica::study {

/// What `--keep group` leaves of a run's folder, besides the maps on the template, the report and
/// the record: the account run.json as "run", summaries by step as "steps", tables of regions as
/// "surface_regions" and "regions", the template's name and a key of what it all depends on.
inline constexpr const char* kKeptName = "kept.json";

/// One number of a region of a hemisphere.
struct RegionNumber {
  std::string atlas;  ///< "surface": that of `explica surface`; "template NAME": the template's
  std::string region, measure, value, unit;
};

/// One row of the study table: a participant's hemisphere and its numbers by column.
struct StudyRow {
  std::string participant;          ///< "sub-01" or "sub-01_ses-02"
  std::string hemisphere;           ///< "L" or "R"
  std::string region;               ///< of a study with several patches; may be empty
  std::string state;                ///< "done", "stopped early", "failed: ...", "implausible ..."
  std::filesystem::path report;     ///< report.html, relative to the study; may be absent
  std::filesystem::path thumbnail;  ///< a small picture of it, likewise
  std::map<std::string, std::string> values;  ///< "surface.euler_characteristic" and so on;
                                              ///< "region.precuneus": mean thickness, mm
  std::vector<RegionNumber> regions;
};

/// The value of a column; "n/a" where the row has none.
[[nodiscard]] std::string valueIn(const StudyRow& row, const std::string& column);

/// What became of a run whose folder holds a problem.txt: "interrupted", or "failed: " and why;
/// empty without one.
[[nodiscard]] std::string problemIn(const std::filesystem::path& run);

/// A run's folder as it is, in the form of kKeptName without name and key; or what was kept of it.
[[nodiscard]] provenance::Json accountOf(const std::filesystem::path& run);

/// Something in a row that a person should look at.
struct StudyFlag {
  std::string column;  ///< "state" or a column of values
  std::string reason;  ///< "Euler characteristic is not 2", "robust z 4.2"
};

/// Rows of all runs below `out/runs`, in the order of their names, whatever became of them.
/// @param subject  "sub-01": only those of this one
[[nodiscard]] std::vector<StudyRow> collectRows(const std::filesystem::path& out,
                                                const std::string& subject = "");

/// What is wrong or unusual in each row: a run that failed or stopped early, a surface that is no
/// sphere or meets itself, and numbers far from the other rows'.
///
/// Far is a robust z of more than 3.5 [IglewiczHoaglin1993]: z = 0.6745 (x - median) / MAD over the
/// rows of the same region, of which there must be 8 with the number.
[[nodiscard]] std::vector<std::vector<StudyFlag>> flagsOf(const std::vector<StudyRow>& rows);

/// Tab-separated, "n/a" where a row has no value (as BIDS wants it); columns in a fixed order: the
/// numbers that a study is about, what is known of people, and regions.
[[nodiscard]] std::string tableText(const std::vector<StudyRow>& rows);

/// All other numbers of the same rows: how each step went.
[[nodiscard]] std::string internalsText(const std::vector<StudyRow>& rows);

/// Regions as a long table, a row a person, hemisphere, region and measure, with what is known of
/// people.
[[nodiscard]] std::string regionsText(const std::vector<StudyRow>& rows);

/// A text as it may stand in a cell: on one line, without tabs.
[[nodiscard]] std::string cellText(std::string text);

/// Begins the name of a column that holds a region's mean thickness, its .sd, .area or .volume.
inline constexpr std::string_view kRegionPrefix = "region.";
/// Begins the name of a column of participants.tsv.
inline constexpr std::string_view kAboutPrefix = "participant.";

/// A column that the table and its page know.
struct KnownColumn {
  const char* name;
  const char* words;  ///< as people call it
  const char* unit;
  bool first;     ///< of those that tell how good a run is, which come first
  bool compared;  ///< alike in all rows, so that one far off is marked
};
/// @return null for all others
[[nodiscard]] const KnownColumn* knownColumn(const std::string& name);

/// Columns of participants.tsv that any row has, by name.
[[nodiscard]] std::vector<std::string> aboutColumns(const std::vector<StudyRow>& rows);
/// Columns of all rows: those that come first, others by name, regions last.
[[nodiscard]] std::vector<std::string> columnsOf(const std::vector<StudyRow>& rows);
[[nodiscard]] bool isRegion(const std::string& column);
[[nodiscard]] bool isRegionMean(const std::string& column);
/// True of a number that should be alike in all rows, so that one far off is marked.
[[nodiscard]] bool isCompared(const std::string& column);
/// True of the columns that tell how good a run is.
[[nodiscard]] bool isFirst(const std::string& column);

}  // namespace explica::study
