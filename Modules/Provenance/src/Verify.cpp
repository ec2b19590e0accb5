// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Verify.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Termination.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace explica::provenance {
namespace {

namespace fs = std::filesystem;

FileState stateOf(const fs::path& path, const Json& entry) {
  try {
    const Digest found = digestOf(path);
    if (!entry.contains("sha256")) return FileState::Unhashed;
    return found.sha256 == entry["sha256"] && entry.value("size", found.size) == found.size
               ? FileState::Same
               : FileState::Changed;
  } catch (const IOError&) {
    return FileState::Missing;
  }
}

/// The record that made an input, where it is now.
std::optional<fs::path> locateParent(const Json& record, std::size_t input,
                                     const fs::path& located) {
  const Json& execution = record["execution"]["inputs"][input];
  if (!execution.contains("parent_record")) return std::nullopt;
  const std::string wanted = record["inputs"][input].value("parent", "");
  if (const auto found = findRecordOf(located, Digest{0, record["inputs"][input]["sha256"]})) {
    if (found->record["id"] == wanted) return found->path;
  }
  return fs::path(execution["parent_record"].value("path", located.parent_path() / kRecordName));
}

void verifyInto(const fs::path& recordPath, bool deep, Verification& all,
                std::set<fs::path>& seen) {
  std::error_code ignored;
  if (!seen.insert(fs::weakly_canonical(recordPath, ignored)).second) return;
  const Json record = readRecord(recordPath);
  ++all.records;
  const fs::path folder = recordPath.parent_path();
  for (std::size_t i = 0; i < record["inputs"].size(); ++i) {
    const Json& input = record["inputs"][i];
    const fs::path path = locateInput(record, i, recordPath);
    all.files.push_back(
        {"input " + input["role"].get<std::string>(), path, stateOf(path, input), recordPath});
    if (!deep) continue;
    if (const auto parent = locateParent(record, i, path)) {
      if (!isThere(*parent)) {
        all.files.push_back(
            {"record of " + path.string(), *parent, FileState::Missing, recordPath});
        continue;
      }
      try {
        verifyInto(*parent, true, all, seen);
      } catch (const Error&) {
        all.files.push_back(
            {"record of " + path.string(), *parent, FileState::Changed, recordPath});
      }
    }
  }
  const Json& varying = record["execution"]["varying_outputs"];
  for (const Json& output : record["outputs"]) {
    const std::string name = output["path"];
    const fs::path path = folder / name;
    const Json* hashed = &output;
    for (const Json& entry : varying) {
      if (entry["path"] == name) hashed = &entry;
    }
    // What a link from elsewhere puts in its place is not this run's file.
    const bool own = ownFile(folder, name).has_value();
    all.files.push_back(
        {"output " + name, path, own ? stateOf(path, *hashed) : FileState::Changed, recordPath});
  }
}

void historyInto(const fs::path& recordPath, int depth, std::ostringstream& text,
                 std::set<fs::path>& seen) {
  const Json record = readRecord(recordPath);
  const Json& software = record["software"];
  const Json& execution = record["execution"];
  // Words and names of a stranger's record: each stays on its line.
  const auto say = [&](const std::string& line) {
    text << std::string(2 * static_cast<std::size_t>(depth), ' ') << printable(line) << '\n';
  };
  auto ended = record["termination"].get<std::string>();
  if (ended == nameOf(Termination::NotRun) || ended == nameOf(Termination::Finished)) {
    const int code = record["exit_code"].get<int>();
    ended = code == 0 ? "done" : "failed with exit code " + std::to_string(code);
  }
  std::ostringstream seconds;
  seconds << execution["seconds"].get<double>();
  say("explica " + record["command"].get<std::string>() + "  (" +
      software["version"].get<std::string>() + ", commit " +
      software["commit"].get<std::string>().substr(0, 10) +
      (software["dirty"].get<bool>() ? ", changed" : "") + "; " +
      execution["started"].get<std::string>() + ", " + seconds.str() + " s; " + ended + ")");
  say("  record: " + recordPath.string());
  std::string argv;
  for (const auto& word : execution["argv"]) argv += " " + word.get<std::string>();
  say("  command line:" + argv);
  for (const auto& warning : record["warnings"]) say("  warning: " + warning.get<std::string>());
  if (!seen.insert(recordPath).second) return;
  for (std::size_t i = 0; i < record["inputs"].size(); ++i) {
    const Json& input = record["inputs"][i];
    const fs::path path = locateInput(record, i, recordPath);
    say("  from " + input["role"].get<std::string>() + ": " + path.string() + "  sha256 " +
        input["sha256"].get<std::string>().substr(0, 12));
    if (const auto parent = locateParent(record, i, path)) {
      if (isThere(*parent)) {
        historyInto(*parent, depth + 2, text, seen);
      } else {
        say("    its record is gone: " + parent->string());
      }
    }
  }
}

}  // namespace

bool Verification::allSame() const {
  return std::ranges::all_of(files, [](const VerifiedFile& file) {
    return file.state == FileState::Same || file.state == FileState::Unhashed;
  });
}

fs::path recordAt(const fs::path& place) {
  if (!isFolder(place)) return place;
  if (isThere(place / kRecordName)) return place / kRecordName;
  throw InvalidInput(place.string() + ": holds no " + kRecordName +
                     "; name a folder that explica has written, or a record");
}

fs::path locateInput(const Json& record, std::size_t input, const fs::path& recordPath) {
  const Json& execution = record["execution"];
  const Json& paths = execution["inputs"].at(input);
  const fs::path given = paths["given"].get<std::string>();
  std::vector<fs::path> candidates;
  if (paths.contains("absolute")) candidates.emplace_back(paths["absolute"].get<std::string>());
  if (execution.contains("directory")) {
    candidates.push_back(fs::path(execution["directory"].get<std::string>()) / given);
  }
  candidates.push_back(given);
  candidates.push_back(recordPath.parent_path() / given);
  candidates.push_back(recordPath.parent_path() / given.filename());
  for (const auto& candidate : candidates) {
    if (isThere(candidate)) return candidate;
  }
  return candidates.front();
}

Verification verifyRecord(const fs::path& record, bool deep) {
  Verification all;
  std::set<fs::path> seen;
  verifyInto(record, deep, all, seen);
  return all;
}

std::string historyOf(const fs::path& file) {
  std::ostringstream text;
  std::set<fs::path> seen;
  const fs::path record = recordAt(file);
  if (record.filename() == kRecordName) {
    historyInto(record, 0, text, seen);
    return text.str();
  }
  const Digest digest = digestOf(file);
  const auto found = findRecordOf(file, digest);
  if (!found) {
    const fs::path beside = fs::absolute(file).parent_path() / kRecordName;
    if (isThere(beside)) static_cast<void>(readRecord(beside));  // one that cannot be read
    throw InvalidInput(file.string() + ": no " + kRecordName +
                       " beside it or above names it; it was not made by explica, or was moved "
                       "without its record");
  }
  text << file.string() << "  sha256 " << digest.sha256.substr(0, 12)
       << (found->sameContent ? "" : "  CHANGED since it was made") << '\n';
  historyInto(found->path, 1, text, seen);
  return text.str();
}

std::vector<fs::path> parentRecords(const fs::path& recordPath) {
  const Json record = readRecord(recordPath);
  std::vector<fs::path> parents;
  for (std::size_t i = 0; i < record["inputs"].size(); ++i) {
    if (const auto parent = locateParent(record, i, locateInput(record, i, recordPath))) {
      parents.push_back(*parent);
    }
  }
  return parents;
}

}  // namespace explica::provenance
