// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "CloseUps.h"

#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/IO/VolumeFile.h"

#include <algorithm>
#include <map>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

/// Rows of a table of this program; none if there is no such file.
std::vector<TableRow> rowsOf(const fs::path& file) {
  return isThere(file) ? tableRows(fileText(file)) : std::vector<TableRow>();
}

/// A cube of the image, and what of its tissue has no thickness.
struct Cell {
  int count = 0;
  Vector sum = Vector::Zero();  ///< of the voxels' indices
};

}  // namespace

std::vector<report::CloseUp> correctedPlaces(const StepFolder& surface, std::size_t most) {
  std::vector<std::pair<double, report::CloseUp>> places;
  for (auto& row : rowsOf(surface.folder / "topology.tsv")) {
    const Point at(numberIn(row, "x_mm"), numberIn(row, "y_mm"), numberIn(row, "z_mm"));
    const double voxels = numberIn(row, "voxels");
    if (!at.allFinite()) continue;
    places.emplace_back(
        voxels, report::CloseUp{at, row["kind"] + " " + row["side"] + ", " + readable(voxels) +
                                        (voxels == 1 ? " voxel" : " voxels")});
  }
  std::ranges::stable_sort(places, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<report::CloseUp> largest;
  for (auto& [size, place] : places) {
    if (largest.size() < most) largest.push_back(std::move(place));
  }
  return largest;
}

std::vector<report::CloseUp> unknownPlaces(const StepFolder& thickness, std::size_t most) {
  if (!thickness.has("thickness.nii.gz") || !thickness.has("harmonic.nii.gz")) return {};
  io::VolumeReadOptions reading{.allowNonFinite = true};
  const Volume<float> known =
      io::readScalars(thickness.folder / "thickness.nii.gz", reading).volume;
  const Volume<float> harmonic =
      io::readScalars(thickness.folder / "harmonic.nii.gz", reading).volume;
  if (known.size() != harmonic.size()) return {};
  constexpr double kCell = 8;  // mm
  std::map<std::array<int, 3>, Cell> cells;
  for (std::size_t v = 0; v < known.size(); ++v) {
    const bool tissue = harmonic[v] > 0 && harmonic[v] < 1;
    if (!tissue || known[v] > 0) continue;
    const auto at = known.grid.subscripts(v);
    std::array<int, 3> key{};
    for (int a = 0; a < 3; ++a) {
      key[a] = static_cast<int>(at[a] * known.grid.spacing[a] / kCell);
    }
    Cell& cell = cells[key];
    ++cell.count;
    cell.sum += Vector(at[0], at[1], at[2]);
  }
  std::vector<Cell> fullest;
  for (const auto& [key, cell] : cells) fullest.push_back(cell);
  std::ranges::stable_sort(fullest, std::ranges::greater{}, &Cell::count);
  std::vector<report::CloseUp> places;
  for (std::size_t n = 0; n < std::min(most, fullest.size()); ++n) {
    places.push_back({known.grid.toWorld(fullest[n].sum / fullest[n].count),
                      readable(fullest[n].count) + (fullest[n].count == 1 ? " voxel" : " voxels")});
  }
  return places;
}

std::vector<CrossingPair> crossingPairs(const StepFolder& step) {
  std::vector<CrossingPair> pairs;
  for (auto& row : rowsOf(step.folder / "intersections.tsv")) {
    const double first = numberIn(row, "face_1"), second = numberIn(row, "face_2");
    CrossingPair pair{.place = Point(numberIn(row, "x"), numberIn(row, "y"), numberIn(row, "z"))};
    if (!pair.place.allFinite() || !(first >= 0) || !(second >= 0)) continue;
    pair.faces = {static_cast<std::int32_t>(first), static_cast<std::int32_t>(second)};
    pair.inRegion = numberIn(row, "faces_in_region") > 0;
    pair.parted = row["parted"] == "yes";
    pairs.push_back(pair);
  }
  return pairs;
}

std::vector<report::CloseUp> crossingPlaces(const std::vector<CrossingPair>& pairs,
                                            std::size_t most) {
  struct Group {
    const CrossingPair* first = nullptr;
    std::size_t count = 0;
  };
  std::vector<Group> groups;
  for (const CrossingPair& pair : pairs) {
    auto near = std::ranges::find_if(
        groups, [&](const Group& group) { return (group.first->place - pair.place).norm() < 3; });
    if (near == groups.end()) near = groups.insert(groups.end(), {&pair, 0});
    ++near->count;
  }
  std::ranges::stable_sort(groups, [](const Group& a, const Group& b) {
    return std::pair(a.first->inRegion, a.count) > std::pair(b.first->inRegion, b.count);
  });
  std::vector<report::CloseUp> places;
  for (std::size_t n = 0; n < std::min(most, groups.size()); ++n) {
    const CrossingPair& pair = *groups[n].first;
    std::string words =
        "faces " + std::to_string(pair.faces[0]) + ", " + std::to_string(pair.faces[1]);
    if (groups[n].count > 1) words += " and " + std::to_string(groups[n].count - 1) + " more";
    places.push_back({pair.place, words + (pair.parted ? ", parted" : "")});
  }
  return places;
}

}  // namespace explica::pipeline
