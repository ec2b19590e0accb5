// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "ReportParts.h"

#include <array>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPictures = 12;             // of a folder on one page
constexpr std::uintmax_t kLargestPicture = 3u << 20;  // bytes: the page stays below 10 MB

/// What a browser calls the picture in a file; empty for other files.
std::string mediaTypeOf(const fs::path& file) {
  if (file.extension() == ".svg") return "image/svg+xml";
  if (file.extension() == ".png") return "image/png";
  return "";
}

/// What a picture shows, by the name that commands give it.
std::string titleOfPicture(const std::string& stem) {
  constexpr std::array kKnown = {
      std::pair{"bullseye", "The wall's segments"},
      std::pair{"slices_ed", "Slices at end-diastole"},
      std::pair{"slices_es", "Slices at end-systole"},
      std::pair{"field", "Interpolant, tangent field, trajectories and grid in a slice"}};
  for (const auto& [name, title] : kKnown) {
    if (stem == name) return title;
  }
  return inWords(stem);
}

}  // namespace

void showOwnPictures(ResultFolder& results, const StepFolder& step) {
  std::vector<fs::path> files;
  for (const fs::path& file : entriesOf(step.folder)) {
    if (mediaTypeOf(file).empty() || !fs::is_regular_file(file)) continue;
    // Of a picture in both forms the drawing is sharper.
    if (file.extension() == ".png" && fs::exists(fs::path(file).replace_extension(".svg")))
      continue;
    if (fs::file_size(file) <= kLargestPicture) files.push_back(file);
  }
  if (files.size() > kMostPictures) files.resize(kMostPictures);
  for (const fs::path& file : files) {
    results.content().drawings.push_back({"", titleOfPicture(file.stem().string()),
                                          step.name + "/" + file.filename().string(),
                                          mediaTypeOf(file), fileText(file)});
  }
}

}  // namespace explica::pipeline
