// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Parse.h"

#include <algorithm>
#include <map>
#include <numeric>

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
  std::string best = meantBy(word, candidates);
  if (!best.empty()) return best;
  std::size_t bestDistance = word.size() / 3 + 2;
  for (const auto& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t substituted = diagonal + (word[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
      }
    }
    if (row.back() < bestDistance) {
      bestDistance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace explica::app
