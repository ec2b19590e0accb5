// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Parse.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <map>

namespace explica::app {
namespace {

/// Words of other programs for what an option does here.
const std::map<std::string, std::vector<std::string>> kSynonyms = {
    {"--side", {"--hemisphere"}},
    {"--jobs", {"--threads"}},
    {"--nthreads", {"--threads"}},
    {"--n-threads", {"--threads"}},
    {"--openmp", {"--threads"}},
    {"--overwrite", {"--force"}},
    {"--clobber", {"--force"}},
    {"--output", {"--out"}},
    {"--subject", {"--participant-label"}},
    {"--subjects", {"--participant-label"}},
    {"--annot", {"--labels", "--parcellation", "--regions", "--atlas"}},
    {"--overlay", {"--map"}},
    {"--size", {"--radius"}},
    {"--steps-max", {"--max-iterations"}},
    {"--iterations", {"--max-iterations"}},
    {"--timeout", {"--max-time"}},
    {"--memory", {"--max-memory"}}};

/// The candidate that the word abbreviates or means; empty if there is none.
std::string meantBy(const std::string& word, const std::vector<std::string>& candidates) {
  constexpr std::size_t kTelling = 5;  // "--" and three letters
  std::string shortest;
  for (const auto& candidate : candidates) {
    if (word.size() < kTelling || !candidate.starts_with(word)) continue;
    if (shortest.empty() || candidate.size() < shortest.size()) shortest = candidate;
  }
  if (!shortest.empty()) return shortest;
  const auto synonyms = kSynonyms.find(word);
  if (synonyms == kSynonyms.end()) return {};
  for (const auto& synonym : synonyms->second) {
    if (std::find(candidates.begin(), candidates.end(), synonym) != candidates.end()) {
      return synonym;
    }
  }
  return {};
}

}  // namespace

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string meant = meantBy(word, candidates);
  if (!meant.empty()) return meant;
  const std::size_t letters = word.size() - std::min(word.find_first_not_of('-'), word.size());
  return nearestOf(word, candidates, letters / 3 + 1);  // two letters in three stay
}

}  // namespace explica::app
