// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"

#include <utility>

namespace explica::sampling {

/// What was sampled, in numbers.
struct SampleSummary {
  std::optional<std::int64_t> vertices, voxels, layers, points;
  std::optional<std::vector<double>> depths;
  std::optional<double> pointsDistance;               ///< mm, largest
  std::vector<std::pair<std::string, double>> known;  ///< share, by a volume's name
};

inline void describe(Results& t, const SampleSummary& s) {
  t.count("vertices", "Vertices", "", s.vertices).inHead();
  t.list("depths", "Depths", "", "0 white, 1 pial.", s.depths);
  t.count("voxels", "Voxels of the tissue", "", s.voxels);
  t.count("layers", "Layers", "", s.layers).inHead();
  t.count("points", "Points", "", s.points).inHead();
  t.number("points_distance_max", "Farthest point from the cortex", "mm",
           "From its nearest column between white and pial.", s.pointsDistance)
      .inHead();
  const auto known = [&](const std::string& name, std::optional<double> share) {
    t.share("known_fraction_" + name, "Known of " + name,
            "Share of the places asked for at which the volume has a value.", share)
        .atLeast(0.95, Judgement::Look, "the image covers the cortex");
  };
  for (const auto& [name, share] : s.known) known(name, share);
  if (s.known.empty()) known("*", std::nullopt);
}

}  // namespace explica::sampling
