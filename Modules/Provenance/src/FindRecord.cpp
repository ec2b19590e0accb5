// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Record.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace explica::provenance {
namespace {

namespace fs = std::filesystem;

/// What tells a file or folder from itself after a change.
using Stamp = std::array<std::int64_t, 4>;

std::optional<Stamp> stampOf(const fs::path& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) return std::nullopt;
  return Stamp{static_cast<std::int64_t>(found.st_ino), found.st_size, found.st_mtim.tv_sec,
               found.st_mtim.tv_nsec};
}

/// What was made of files of late, so that thousands of inputs do not each read the record of the
/// folder that they share.  Made anew where the file has changed.
template <class Made>
class Remembered {
 public:
  /// @return nullptr if there is no such file or folder
  template <class Make>
  const Made* of(const fs::path& path, const Make& make) {
    const auto stamp = stampOf(path);
    if (!stamp) return nullptr;
    const auto at = made_.find(path.native());
    if (at != made_.end() && at->second.first == *stamp) return &at->second.second;
    if (at == made_.end() && made_.size() >= 16) made_.clear();
    return &(made_[path.native()] = {*stamp, make(path)}).second;
  }

 private:
  std::map<std::string, std::pair<Stamp, Made>> made_;
};

/// A record and what it lists; null where the file is no record of ours.
struct Listing {
  Json record;
  std::map<std::string, std::string> hashOf;  ///< by name
  std::set<std::string> hashes;
};

Listing listingOf(const fs::path& path) {
  Listing listing;
  std::error_code unknown;
  if (!fs::is_regular_file(path, unknown)) return listing;
  try {
    listing.record = readRecord(path);
  } catch (const Error&) {
    return {};  // another program's provenance.json, or a damaged one
  }
  for (const Json& output : hashedOutputs(listing.record)) {
    listing.hashOf.emplace(output["path"], output["sha256"]);
    listing.hashes.insert(output["sha256"]);
  }
  return listing;
}

/// The record, if it lists `name` or, without a name, a file of this content.
std::optional<FoundRecord> listedIn(const fs::path& candidate,
                                    const std::optional<std::string>& name, const Digest& digest) {
  thread_local Remembered<Listing> remembered;
  const Listing* const listing = remembered.of(candidate, listingOf);
  if (listing == nullptr) return std::nullopt;
  if (!name) {
    if (!listing->hashes.contains(digest.sha256)) return std::nullopt;
    return FoundRecord{candidate, listing->record, true};
  }
  const auto at = listing->hashOf.find(*name);
  if (at == listing->hashOf.end()) return std::nullopt;
  return FoundRecord{candidate, listing->record, at->second == digest.sha256};
}

std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& entry : entriesOf(folder)) names.push_back(entry.filename().string());
  return names;  // sorted
}

/// A derivative's sub-01/.../sub-01_hemi-L_white.surf.gii is a copy of what a step of
/// runs/sub-01_hemi-L* has written, its sub-01_desc-brain_mask.nii.gz of a step of any run of
/// sub-01.
std::optional<FoundRecord> recordInRuns(const fs::path& study, const std::string& name,
                                        const Digest& digest) {
  if (!name.starts_with("sub-")) return std::nullopt;
  thread_local Remembered<std::vector<std::string>> remembered;
  const fs::path runs = study / "runs";
  const std::vector<std::string>* const names = remembered.of(runs, namesIn);
  if (names == nullptr) return std::nullopt;
  const auto hemi = name.find("_hemi-");
  const std::string beginning =
      name.substr(0, name.find('_', hemi == std::string::npos ? 0 : hemi + 1));
  for (auto run = std::ranges::lower_bound(*names, beginning);
       run != names->end() && run->starts_with(beginning); ++run) {
    for (const fs::path& step : entriesOf(runs / *run)) {
      if (auto found = listedIn(step / kRecordName, std::nullopt, digest)) return found;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<FoundRecord> findRecordOf(const fs::path& file, const Digest& digest) {
  constexpr int kFoldersAbove = 3;  // outputs lie in their record's folder or shortly below it
  std::error_code fault;
  const auto absolute = fs::weakly_canonical(file, fault);
  if (fault) return std::nullopt;
  auto folder = absolute.parent_path();
  for (int level = 0; level <= kFoldersAbove && !folder.empty(); ++level) {
    const auto candidate = folder / kRecordName;
    if (candidate != absolute) {
      const auto name = absolute.lexically_relative(folder).generic_string();
      if (auto found = listedIn(candidate, name, digest)) return found;
    }
    if (auto found = recordInRuns(folder, absolute.filename().string(), digest)) return found;
    if (folder == folder.root_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

}  // namespace explica::provenance
