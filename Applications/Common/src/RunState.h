// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Provenance/Record.h"
#include "Meeting.h"
#include "OutputFolder.h"
#include "Run.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace explica::app {

/// Ends a dry run at the first step.
struct DryRunEnds {};

/// What a run has read, found out and written so far.
struct Context::State {
  using Json = provenance::Json;

  Run& run;
  Console& console;
  provenance::Record record;
  Json summary = Json::object();
  Monitor monitor;
  std::optional<OutputFolder> folder = {};
  std::vector<std::string> varying = {};  ///< names of outputs whose bytes may differ
  std::vector<std::pair<std::string, std::filesystem::path>> nestedRecords = {};
  std::optional<Json> flags = {};  ///< numbers outside of their limits; nothing if none was judged
  bool plausible = true;
  std::vector<std::pair<Judgement, std::string>> reasons = {};  ///< of results that are not good
  std::vector<std::string> head = {};                           ///< results to end with, in words
  std::optional<Meeting> meeting = {};                          ///< the files read so far
  std::set<std::pair<std::string, std::string>> known = {};     ///< role and path of the same
  Stopwatch seconds = {};

  [[nodiscard]] bool doubtful() const {
    return !plausible || std::any_of(reasons.begin(), reasons.end(), [](const auto& reason) {
      return reason.first == Judgement::Doubt;
    });
  }
  /// What a step's summary says against its results is said of the whole, too.
  void adoptReasons(const std::string& step, const std::filesystem::path& recordPath) {
    const Json results = provenance::readRecord(recordPath)["results"];
    const bool doubtful = results.value("verdict", "") == "doubtful";
    for (const Json& reason : results.value("reasons", Json::array())) {
      reasons.emplace_back(doubtful ? Judgement::Doubt : Judgement::Look,
                           step + ": " + reason.get<std::string>());
    }
  }
  /// What steps done apart have found and written counts as if done here.
  void adopt(State&& part);
  /// Why the verdict is not "right", in sentences.
  [[nodiscard]] Json reasonsInWords() const;
  /// "right", "look", "doubtful" or "stopped": the worst of what can be said.
  [[nodiscard]] const char* verdict(const Json& reasonsInWords) const;
  [[nodiscard]] const Declaration& declaration() const { return run.invocation.declaration; }
  void setResult(const std::string& key, Json value) { summary[key] = std::move(value); }
};

}  // namespace explica::app
