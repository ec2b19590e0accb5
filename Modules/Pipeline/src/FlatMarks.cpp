// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/FlatMarks.h"

#include "Explica/Flattening/PatchTable.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VertexDataFile.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

namespace explica::pipeline {

void markRegions(const io::LabelMap& regions, const TriangleMesh& flat, report::FlatMarks& marks) {
  std::map<Label, report::Colour> colours;
  for (const io::LabelEntry& entry : regions.table) {
    colours[entry.key] = report::colourOfLabel(entry.key, entry.colour);
    marks.regions.try_emplace(colours[entry.key], entry.name);
  }
  const auto colourOf = [&](Label key) {
    const auto found = colours.find(key);
    return found == colours.end() ? std::nullopt : std::optional(found->second);
  };
  for (const auto& piece : flattening::outlines(flat.faces, flat.positions, regions.keys)) {
    marks.lines.push_back(
        {piece.from, piece.to, colourOf(piece.sides[0]), colourOf(piece.sides[1])});
  }
  const auto places = flattening::regionPlaces(flat, regions.keys);
  std::vector<std::pair<std::ptrdiff_t, const io::LabelEntry*>> bySize;
  for (const io::LabelEntry& entry : regions.table) {
    bySize.emplace_back(-std::ranges::count(regions.keys, entry.key), &entry);
  }
  std::ranges::stable_sort(bySize, [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [size, entry] : bySize) {
    if (io::meansNoRegion(entry->name) || !places.contains(entry->key)) continue;
    marks.names.emplace_back(places.at(entry->key), entry->name);
  }
}

void markDirections(const Positions& folded, const TriangleMesh& flat, report::FlatMarks& marks) {
  constexpr double kLeastShare = 0.4;  // of the variance; below, half of the map goes elsewhere
  constexpr std::array kLetters = {std::array{"R", "L"}, std::array{"A", "P"},
                                   std::array{"S", "I"}};
  const Eigen::MatrixX2d at =
      flat.positions.leftCols<2>().rowwise() - flat.positions.leftCols<2>().colwise().mean();
  const Positions from = folded.rowwise() - folded.colwise().mean();
  const Eigen::LDLT<Eigen::Matrix2d> moments((at.transpose() * at).eval());
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector2d gradient = moments.solve(at.transpose() * from.col(axis));
    if ((at * gradient).squaredNorm() < kLeastShare * from.col(axis).squaredNorm()) continue;
    if (!(gradient.norm() > 0)) continue;
    marks.directions.emplace_back(gradient.normalized(), kLetters[axis][0]);
    marks.directions.emplace_back(-gradient.normalized(), kLetters[axis][1]);
  }
}

}  // namespace explica::pipeline
