// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PolygonKind.h"

namespace explica::app {
namespace {

void declare(Declaration& d, PolygonKindSettings& s) {
  declareKind(d, s, "polygon with an intricate region of 19 edges",
              "explica phantom polygon19 --out p19");
}

Termination run(Context& context, const PolygonKindSettings& s) {
  return runKind(context, s, planar::makePolygon19());
}

}  // namespace

Command phantomPolygon19Command() {
  return makeCommand<PolygonKindSettings>("phantom polygon19", declare, run);
}

}  // namespace explica::app
