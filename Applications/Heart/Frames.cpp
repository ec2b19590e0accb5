// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Frames.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/IO/VolumeSeries.h"

#include <nlohmann/json.hpp>

#include <array>
#include <charconv>
#include <cmath>

namespace explica::app {
namespace {

constexpr int kMostFrames = 1000;  // of a beat; far beyond any scanner's

/// One frame of a series of labels.
Volume<Label> labelsOf(const std::vector<float>& values, const Grid& grid, const std::string& path,
                       int frame) {
  constexpr float kMostExact = 1 << 24;  // whole numbers beyond are not kept by single precision
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (!(std::abs(values[v]) < kMostExact) || values[v] != std::round(values[v])) {
      throw InvalidInput("'" + path + "': frame " + std::to_string(frame) +
                         " holds values that are no labels, such as " + std::to_string(values[v]));
    }
    labels[v] = static_cast<Label>(values[v]);
  }
  return labels;
}

/// The numbers in "0,9"; nothing if the text is something else.
std::optional<std::array<int, 2>> twoNumbers(const std::string& text) {
  std::array<int, 2> numbers{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t n = 0; n < 2; ++n) {
    const auto [next, error] = std::from_chars(at, end, numbers[n]);
    if (error != std::errc{} || (n == 0 ? next == end || *next != ',' : next != end)) return {};
    at = next + 1;
  }
  return numbers;
}

}  // namespace

std::vector<Volume<Label>> readFrames(Context& context, const std::vector<std::string>& paths,
                                      const io::VolumeReadOptions& reading) {
  std::vector<Volume<Label>> frames;
  for (std::size_t f = 0; f < paths.size(); ++f) {
    const std::string& path = paths[f];
    io::VolumeReadOptions options = reading;
    options.allowAllZero = true;
    options.frame = 0;
    const io::LoadedVolume<Label> first = io::readLabels(path, options);
    const auto& size = first.origin.storedSize;
    const int count = size.size() > 3 ? size[3] : 1;
    if (count > kMostFrames) {
      throw InvalidInput("'" + path + "' holds " + std::to_string(count) + " frames; at most " +
                         std::to_string(kMostFrames) + " are possible");
    }
    context.note("SEG " + std::to_string(f),
                 nlohmann::ordered_json{{"format", first.origin.format},
                                        {"stored_size", size},
                                        {"placement", first.origin.placement},
                                        {"notes", first.origin.notes}});
    if (count == 1) {
      frames.push_back(first.volume);
      continue;
    }
    options.frame.reset();
    io::VolumeSeries series(path, options);
    for (int n = 0; n < count; ++n) {
      frames.push_back(labelsOf(series.next(1), first.volume.grid, path, n));
    }
  }
  return frames;
}

std::vector<Volume<float>> readImages(const std::vector<std::string>& paths,
                                      const io::VolumeReadOptions& reading, const Grid& grid,
                                      std::size_t count) {
  std::vector<Volume<float>> images;
  for (const std::string& path : paths) {
    io::VolumeSeries series(path, reading);
    if (!sameGrid(series.grid(), grid)) {
      throw InvalidInput("--image '" + path +
                         "': its voxels lie elsewhere than those of the labels");
    }
    for (int f = 0; f < series.frames() && images.size() <= count; ++f) {
      images.emplace_back(grid).data = series.next(1);
    }
  }
  if (!paths.empty() && images.size() != count) {
    throw InvalidInput("--image: " + std::to_string(images.size()) + " frames, but " +
                       std::to_string(count) + " of labels");
  }
  return images;
}

Chosen chooseFrames(const std::string& wanted, const std::vector<Volume<Label>>& hearts) {
  const auto count = static_cast<int>(hearts.size());
  Chosen chosen;
  const std::string lower = lowerCase(wanted);
  if (lower == "all") {
    for (int f = 0; f < count; ++f) chosen.numbers.push_back(f);
    return chosen;
  }
  const ventricle::Phases found = ventricle::phasesOf(hearts);
  std::array<int, 2> two = {static_cast<int>(found.diastole), static_cast<int>(found.systole)};
  if (lower != "ed,es") {
    const auto numbers = twoNumbers(lower);
    if (!numbers) {
      throw UsageError("--phases takes all, ED,ES or two numbers as 0,9; found '" + wanted + "'");
    }
    two = *numbers;
    for (const int n : two) {
      if (n < 0 || n >= count) {
        throw UsageError("--phases " + wanted + ": there is no frame " + std::to_string(n) + "; " +
                         std::to_string(count) + " were read, counted from 0");
      }
    }
  }
  chosen.numbers = {two[0]};
  chosen.phases = ventricle::Phases{0, 0};
  if (two[1] != two[0]) {
    chosen.numbers.push_back(two[1]);
    chosen.phases->systole = 1;
  }
  return chosen;
}

}  // namespace explica::app
