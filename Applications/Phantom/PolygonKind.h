// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <nlohmann/json.hpp>

namespace explica::app {

struct PolygonKindSettings {
  double spacing = 1;
};

inline void declareKind(Declaration& d, PolygonKindSettings& s, const char* synopsis,
                        const char* example) {
  d.synopsis(synopsis)
      .description(
          "A closed polygon whose upper side is folded, with the region and the viewpoint that "
          "'explica polygon' takes, and what is known of them.")
      .example(example, "Writes polygon.csv; summary.json names region and viewpoint")
      .option("Polygon", Field{"spacing", "mm", "size of a pixel"}, s.spacing)
      .output("polygon.csv", FileKind::Polygon, "vertices in order, counter-clockwise");
}

inline Termination runKind(Context& context, const PolygonKindSettings& s,
                           planar::PolygonPhantom phantom) {
  if (!(s.spacing > 0)) throw UsageError("--spacing must be positive");
  auto step = context.step("generate");
  phantom.curve.positions *= s.spacing;
  phantom.viewpoint *= s.spacing;
  io::writePolygonCsv(context.output("polygon.csv"), phantom.curve.positions);
  const planar::Region region = planar::regionBetween(phantom.curve, phantom.first, phantom.last);
  const planar::PolygonVisibility visibility =
      planar::polygonVisibility(phantom.curve, region, phantom.viewpoint);
  context.result("viewpoint", std::vector<double>{phantom.viewpoint.x(), phantom.viewpoint.y()});
  context.result("region", nlohmann::ordered_json{phantom.first, phantom.last});
  context.result("region_edges", region.edgeCount);
  context.result("length", visibility.length);
  context.result("visibility", visibility.average);
  context.result("flux_variance", visibility.variance);
  context.result("seen", planar::visiblePart(phantom.curve, region, phantom.viewpoint).fraction);
  return Termination::NotRun;
}

}  // namespace explica::app
