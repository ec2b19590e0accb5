// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Termination.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Json.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::provenance {

inline constexpr const char* kRecordName = "provenance.json";
inline constexpr const char* kSummaryName = "summary.json";

/// The record that made an input: found beside it, and naming it with the same hash.
struct Parent {
  std::string id;              ///< of the parent record
  std::string sha256;          ///< of the parent record's file
  std::filesystem::path path;  ///< where it was found
};

/// A file that was read.
struct InputFile {
  std::string role;                ///< the argument or option that named it
  std::filesystem::path given;     ///< path as given
  std::filesystem::path absolute;  ///< the same, absolute
  Digest digest;
  std::optional<Parent> parent;
};

/// A file that was written, by its path relative to the record.
struct OutputFile {
  std::string path;
  Digest digest;
  bool varies = false;  ///< holds times or the like, so that its bytes differ between equal runs
};

/// A part of the work.
struct StepEntry {
  std::string name;
  double seconds = 0;
  std::optional<int> iterations;
  Termination termination = Termination::NotRun;
};

/// How one run of a command came about and went.
///
/// Written as JSON, all that may differ between two equal runs (times, host, paths, threads) stands
/// in the one block `execution`; the rest is equal byte for byte.
struct Record {
  std::string command;              ///< "thickness"
  Json options = Json::object();    ///< every option with its value, given or default; no paths
  std::vector<std::string> given;   ///< names of those that were set: the others are defaults
  Json arguments = Json::object();  ///< paths and words as given, by argument or option name
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;
  std::vector<StepEntry> steps;
  std::vector<std::string> warnings;
  Termination termination = Termination::NotRun;
  int exitCode = 0;
  Json results = Json::object();   ///< summary.json without times
  Json meanings = Json::object();  ///< title, unit, meaning and judgement of each result, by key
  Json notes = Json::object();     ///< how each input was understood (affine used, ...)

  std::vector<std::string> argv;
  std::filesystem::path directory;  ///< working directory
  std::filesystem::path out;        ///< where outputs went, absolute
  std::string started, ended;       ///< UTC, ISO 8601
  double seconds = 0;
  double cpuSeconds = 0;  ///< of the process, with what else it did meanwhile
  std::uint64_t peakMemoryBytes = 0;
  int threads = 0;
  std::string threadsBecause;  ///< what decided the number of threads
  bool withNames = true;       ///< false leaves out host and user, and absolute paths

  /// Equal work has an equal id: SHA-256 of software version, command, options, input hashes.
  [[nodiscard]] std::string id() const;
};

[[nodiscard]] Json toJson(const Record& record);

/// Names of files without their folders, wherever paths stand in a text: for what shall not tell of
/// the machine.  A path begins with '/', '~' or "../", or holds '/' and ends in a name with a dot.
[[nodiscard]] std::string textWithoutFolders(std::string_view text);
/// The same for every text in a value.
[[nodiscard]] Json withoutFolders(const Json& value);

/// The JSON schema that every record obeys.
[[nodiscard]] std::string_view recordSchema();

/// Reads a record and checks it against the schema.  A record may come from a stranger: each output
/// must have a name within the record's folder, without control characters.
/// @throws IOError  absent, not JSON, or not a record: names the file and the first fault
[[nodiscard]] Json readRecord(const std::filesystem::path& path);

/// The outputs whose hash a record tells, those that vary between equal runs last.
[[nodiscard]] std::vector<Json> hashedOutputs(const Json& record);

/// True for a relative path without ".." and control characters: it stays below where it starts.
[[nodiscard]] bool staysBelow(const std::filesystem::path& name);

/// Where a record's output lies, unless a link on the way leads out of the record's folder.
[[nodiscard]] std::optional<std::filesystem::path> ownFile(const std::filesystem::path& folder,
                                                           const std::filesystem::path& name);

/// A text for a terminal: control characters, by which a stranger could write over what was said
/// before, become '?'.
[[nodiscard]] std::string printable(std::string_view text);

/// Looks beside `file`, and in the folders above within three steps, for a record that lists it;
/// for a copy by BIDS's name, for a record below the study's `runs` that lists its content.
struct FoundRecord {
  std::filesystem::path path;
  Json record;
  bool sameContent = false;  ///< the record's hash of the file is the file's hash
};
[[nodiscard]] std::optional<FoundRecord> findRecordOf(const std::filesystem::path& file,
                                                      const Digest& digest);

}  // namespace explica::provenance
