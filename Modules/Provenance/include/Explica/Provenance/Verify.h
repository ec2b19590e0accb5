// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Record.h"

namespace explica::provenance {

enum class FileState {
  Same,     ///< size and hash are as recorded
  Changed,  ///< another content
  Missing,  ///< no such file, or it cannot be read
  Unhashed  ///< its bytes may differ between equal runs; present
};

struct VerifiedFile {
  std::string what;            ///< "input SEG", "output thickness.nii.gz", "record"
  std::filesystem::path path;  ///< where it was looked for
  FileState state = FileState::Missing;
  std::filesystem::path record;  ///< the record that names it
};

struct Verification {
  std::vector<VerifiedFile> files;
  int records = 0;  ///< how many records were followed

  [[nodiscard]] bool allSame() const;
};

/// The record that a user names: the file itself, or the one in that folder.
[[nodiscard]] std::filesystem::path recordAt(const std::filesystem::path& place);

/// Where an input of a record is now: its absolute path, else as given from the working directory
/// of then, else relative to the record, else beside the record.
[[nodiscard]] std::filesystem::path locateInput(const Json& record, std::size_t input,
                                                const std::filesystem::path& recordPath);

/// Compares every input and output of a record with what lies on the disk; with `deep`, the inputs'
/// own records too, back to files that no record made.
/// @throws IOError  the record itself cannot be read
[[nodiscard]] Verification verifyRecord(const std::filesystem::path& record, bool deep = false);

/// A readable account of how a file came about, newest step first.
/// @throws InvalidInput  no record names the file
[[nodiscard]] std::string historyOf(const std::filesystem::path& file);

/// Where the records of the steps that made a record's inputs are now; they may be gone.
[[nodiscard]] std::vector<std::filesystem::path> parentRecords(const std::filesystem::path& record);

}  // namespace explica::provenance
