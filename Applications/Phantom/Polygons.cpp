// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Application/Command.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <nlohmann/json.hpp>

namespace explica::app {
namespace {

struct PolygonKindSettings {
  double spacing = 1;
};

void declareKind(Declaration& d, PolygonKindSettings& s, const char* synopsis,
                 const char* example) {
  d.synopsis(synopsis)
      .description(
          "A closed polygon whose upper side is folded, with the region and the viewpoint that "
          "'explica polygon' takes, and what is known of them.")
      .example(example, "Writes polygon.csv; summary.json names region and viewpoint")
      .category("Polygon")
      .option({"spacing", "mm", "size of a pixel"}, s.spacing)
      .output("polygon.csv", FileKind::Polygon, "vertices in order, counter-clockwise");
}

Termination runKind(Context& context, const PolygonKindSettings& s,
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

void declare19(Declaration& d, PolygonKindSettings& s) {
  declareKind(d, s, "polygon with an intricate region of 19 edges",
              "explica phantom polygon19 --out p19");
}

void declare34(Declaration& d, PolygonKindSettings& s) {
  declareKind(d, s, "polygon with a highly convoluted region of 34 edges",
              "explica phantom polygon34 --out p34");
}

template <planar::PolygonPhantom (*Make)()>
Termination runWith(Context& context, const PolygonKindSettings& s) {
  return runKind(context, s, Make());
}

}  // namespace

Command phantomPolygon19Command() {
  return makeCommand<PolygonKindSettings>("phantom polygon19", declare19,
                                          runWith<planar::makePolygon19>);
}

Command phantomPolygon34Command() {
  return makeCommand<PolygonKindSettings>("phantom polygon34", declare34,
                                          runWith<planar::makePolygon34>);
}

}  // namespace explica::app
