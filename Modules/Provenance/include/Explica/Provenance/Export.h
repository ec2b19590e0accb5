// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Record.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace explica::provenance {

// Records in the words of others.  None of them names a host, a user or a folder outside the study:
// files are named by their path below the study, others by their name and hash.

/// A record and where it lies.
struct LocatedRecord {
  std::filesystem::path path;
  Json record;
};

/// Every record below a folder that can be read, in the order of their paths.
[[nodiscard]] std::vector<LocatedRecord> recordsBelow(const std::filesystem::path& folder);

/// A record and those of the steps that its inputs came from, back to the first.
/// @throws IOError  the first record cannot be read
[[nodiscard]] std::vector<LocatedRecord> recordsBehind(const std::filesystem::path& record);

/// "run-" and the record's id: what exports call the activity that a record tells of.
[[nodiscard]] std::string activityName(const Json& record);

/// W3C PROV-JSON [PROV-JSON]: an entity a file content (its hash is its name), an activity a
/// record, a software agent a version, and who used and generated what.
[[nodiscard]] Json toProvJson(const std::vector<LocatedRecord>& records);

/// BIDS-Prov (BEP028): the files `prov-explica_{act,ent,env,soft}.json` by name.
/// @param root  of the study: files below it are named "bids::path"
[[nodiscard]] std::map<std::string, Json> toBidsProv(const std::vector<LocatedRecord>& records,
                                                     const std::filesystem::path& root);

}  // namespace explica::provenance
