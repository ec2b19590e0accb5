// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What takes the window's place in a build without Qt.
#include "Explica/Core/Errors.h"
#include "Explica/Viewer/Window.h"

namespace explica::viewer {

bool hasWindow() {
  return false;
}

void showWindow(Session&, const WindowCalls&, const WindowOptions&) {
  throw EnvironmentError(
      "this build of explica has no window (it was built without Qt 5 and VTK's Qt widget); use "
      "--screenshot or --film");
}

}  // namespace explica::viewer
