// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PolygonKind.h"

namespace explica::app {
namespace {

void declare(Declaration& d, PolygonKindSettings& s) {
  declareKind(d, s, "polygon with a highly convoluted region of 34 edges",
              "explica phantom polygon34 --out p34");
}

Termination run(Context& context, const PolygonKindSettings& s) {
  return runKind(context, s, planar::makePolygon34());
}

}  // namespace

Command phantomPolygon34Command() {
  return makeCommand<PolygonKindSettings>("phantom polygon34", declare, run);
}

}  // namespace explica::app
