// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/RunState.h"

#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Json.h"

#include <array>

namespace explica::pipeline {
namespace {

/// By the value of StepState.
constexpr std::array kWords = {"done", "stopped", "interrupted", "failed", "missing"};

report::StepState stateOf(const std::string& word) {
  for (std::size_t s = 0; s < kWords.size(); ++s) {
    if (word == kWords[s]) return static_cast<report::StepState>(s);
  }
  return report::StepState::Missing;
}

}  // namespace

void writeRunState(const std::filesystem::path& file, const std::vector<StepNote>& steps) {
  provenance::Json all = provenance::Json::array();
  for (const StepNote& step : steps) {
    all.push_back({{"name", step.name},
                   {"command", step.command},
                   {"state", kWords[static_cast<std::size_t>(step.state)]},
                   {"message", step.message}});
  }
  provenance::writeJson(file, provenance::Json{{"steps", all}});
}

std::vector<StepNote> readRunState(const std::filesystem::path& file) {
  std::vector<StepNote> steps;
  if (!isThere(file)) return steps;
  const provenance::Json state = provenance::readJson(file);
  const provenance::Json entries = state.value("steps", provenance::Json::array());
  for (const provenance::Json& entry : entries) {
    steps.push_back({entry.value("name", ""), entry.value("command", ""),
                     stateOf(entry.value("state", "missing")), entry.value("message", "")});
  }
  return steps;
}

}  // namespace explica::pipeline
