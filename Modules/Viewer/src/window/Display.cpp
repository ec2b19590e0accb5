// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Apart from all that includes Qt, whose names the X library's macros would break.
#include "Display.h"

#include "Explica/Core/Errors.h"

#include <X11/Xlib.h>

#include <cstdlib>
#include <string>

namespace explica::viewer {
namespace {

std::string valueOf(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

}  // namespace

void requireDisplay() {
  if (!valueOf("QT_QPA_PLATFORM").empty()) return;  // the user has said what to draw on
  const std::string name = valueOf("DISPLAY");
  Display* display = name.empty() ? nullptr : XOpenDisplay(name.c_str());
  if (display == nullptr) {
    throw EnvironmentError(
        "no window can be opened: " +
        (name.empty() ? "DISPLAY is not set" : "the display '" + name + "' does not answer") +
        "; use --screenshot, which needs none, or log in with a display (ssh -X)");
  }
  XCloseDisplay(display);
}

}  // namespace explica::viewer
