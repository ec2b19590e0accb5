// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "ReportParts.h"

#include <algorithm>
#include <iterator>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPictures = 12;             // of a folder on one page
constexpr std::uintmax_t kLargestPicture = 3u << 20;  // bytes: the page stays below 10 MB

/// What a browser calls the picture in a file; empty for other files.
std::string mediaTypeOf(const fs::path& file) {
  if (file.extension() == ".svg") return "image/svg+xml";
  if (file.extension() == ".png") return "image/png";
  if (file.extension() == ".gif") return "image/gif";
  return "";
}

/// A picture by the name that commands give it; with a guide, it stands in the head of the page.
struct Known {
  const char *stem, *title, *guide;
  bool hasPanels = false;  ///< each a layer, side by side
};
constexpr Known kKnown[] = {
    {"bullseye", "The wall's segments",
     "Right: thickness changes little by little from segment to segment. Wrong: one segment far "
     "from its neighbours; look at its slices.",
     true},
    {"slices_ed", "Slices at end-diastole", ""},
    {"slices_es", "Slices at end-systole", ""},
    {"slices", "Slices over time",
     "Right: red on the cavity's border, blue on the wall's outer one, in every frame. Wrong: a "
     "line through the cavity, fat or the right ventricle. Then: correct the labels there and "
     "run again."},
    {"field", "Interpolant, tangent field, trajectories and grid in a slice", ""}};

int layersOf(const std::string& svg) {
  const std::string layer = "inkscape:groupmode=\"layer\"";
  int count = 0;
  for (std::size_t at = svg.find(layer); at != std::string::npos; at = svg.find(layer, at + 1)) {
    ++count;
  }
  return count;
}

report::ReportDrawing drawingOf(const StepFolder& step, const fs::path& file) {
  const std::string stem = file.stem().string();
  const auto known =
      std::ranges::find_if(kKnown, [&](const Known& one) { return stem == one.stem; });
  const bool isKnown = known != std::end(kKnown);
  report::ReportDrawing drawing{"",
                                isKnown ? known->title : inWords(stem),
                                "File: " + step.name + "/" + file.filename().string(),
                                mediaTypeOf(file),
                                fileText(file),
                                isKnown ? known->guide : ""};
  if (isKnown && known->hasPanels) drawing.panels = std::max(1, layersOf(drawing.bytes));
  return drawing;
}

}  // namespace

void showOwnPictures(ResultFolder& results, const StepFolder& step) {
  std::vector<fs::path> files;
  for (const fs::path& file : entriesOf(step.folder)) {
    if (mediaTypeOf(file).empty() || !fs::is_regular_file(file)) continue;
    // Of a picture in both forms the drawing is sharper.
    if (file.extension() == ".png" && isThere(fs::path(file).replace_extension(".svg"))) continue;
    if (fs::file_size(file) <= kLargestPicture) files.push_back(file);
  }
  if (files.size() > kMostPictures) files.resize(kMostPictures);
  for (const fs::path& file : files) {
    results.content().drawings.push_back(drawingOf(step, file));
  }
}

}  // namespace explica::pipeline
