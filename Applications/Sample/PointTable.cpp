// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PointTable.h"

#include "Explica/Core/Text.h"

namespace explica::app {

std::string textOf(const io::PointTable& table, const std::vector<sampling::ColumnPlace>& places,
                   const sampling::Regions& regions) {
  std::string text = table.heading + "\tvertex\tdepth\tdistance\tregion\n";
  for (std::size_t n = 0; n < places.size(); ++n) {
    const sampling::ColumnPlace& place = places[n];
    const std::string& region = regions.nameAt(static_cast<std::size_t>(place.vertex));
    text += table.rows[n] + "\t" + std::to_string(place.vertex) + "\t" + cellText(place.depth) +
            "\t" + cellText(place.distance) + "\t" + (region.empty() ? "n/a" : region) + "\n";
  }
  return text;
}

}  // namespace explica::app
