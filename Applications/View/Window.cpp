// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The program explica-window: `explica view`, with a window.

#include "View.h"

#include "Explica/Application/Execute.h"
#include "Explica/Viewer/Window.h"

namespace explica::app {

const std::vector<Command>& allCommands() {
  static const std::vector<Command> all = {viewCommandShowing(viewer::showWindow)};
  return all;
}

}  // namespace explica::app

int main(int argc, char** argv) {
  return explica::app::runMain(argc, argv);
}
