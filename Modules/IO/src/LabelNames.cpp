// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/LabelNames.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <vector>

namespace explica::io {
namespace {

namespace fs = std::filesystem;

/// Words of a line: split at tabs if it has any, so that names may hold spaces; else at spaces.
std::vector<std::string> wordsOf(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  std::string word;
  if (line.find('\t') != std::string::npos) {
    while (std::getline(stream, word, '\t')) words.push_back(word);
  } else {
    while (stream >> word) words.push_back(word);
  }
  return words;
}

}  // namespace

std::optional<fs::path> findLegend(const fs::path& volume) {
  fs::path stem = volume;
  if (stem.extension() == ".gz") stem.replace_extension();
  fs::path text = stem;
  text += ".txt";
  for (const fs::path& legend : {fs::path(stem).replace_extension(".tsv"), text}) {
    std::error_code ignored;
    if (fs::is_regular_file(legend, ignored)) return legend;
  }
  return std::nullopt;
}

LabelNames readLabelNames(const fs::path& legend) {
  std::ifstream file(legend);
  if (!file) throw IOError(legend.string() + ": cannot be opened");
  LabelNames names;
  std::size_t index = 0, name = 1;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    const auto words = wordsOf(line);
    const auto heading = [&](const char* word) {
      return static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin());
    };
    if (names.empty() && heading("index") < words.size() && heading("name") < words.size()) {
      index = heading("index");
      name = heading("name");
      continue;
    }
    try {
      if (words.size() <= std::max(index, name)) throw std::invalid_argument("too short");
      names[static_cast<Label>(std::stol(words[index]))] = words[name];
    } catch (const std::exception&) {
      throw InvalidInput(legend.string() + ": line " + std::to_string(number) +
                         " has no number and name");
    }
  }
  return names;
}

std::string freeSurferRegion(Label label) {
  static constexpr std::array kNames = {"bankssts",
                                        "caudalanteriorcingulate",
                                        "caudalmiddlefrontal",
                                        "corpuscallosum",
                                        "cuneus",
                                        "entorhinal",
                                        "fusiform",
                                        "inferiorparietal",
                                        "inferiortemporal",
                                        "isthmuscingulate",
                                        "lateraloccipital",
                                        "lateralorbitofrontal",
                                        "lingual",
                                        "medialorbitofrontal",
                                        "middletemporal",
                                        "parahippocampal",
                                        "paracentral",
                                        "parsopercularis",
                                        "parsorbitalis",
                                        "parstriangularis",
                                        "pericalcarine",
                                        "postcentral",
                                        "posteriorcingulate",
                                        "precentral",
                                        "precuneus",
                                        "rostralanteriorcingulate",
                                        "rostralmiddlefrontal",
                                        "superiorfrontal",
                                        "superiorparietal",
                                        "superiortemporal",
                                        "supramarginal",
                                        "frontalpole",
                                        "temporalpole",
                                        "transversetemporal",
                                        "insula"};
  const Label within = label % 1000;
  const bool cortex = label / 1000 == 1 || label / 1000 == 2;
  if (!cortex || within < 1 || within > static_cast<Label>(kNames.size())) return "";
  return kNames[static_cast<std::size_t>(within - 1)];
}

}  // namespace explica::io
