// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The window is loaded when it is asked for, since Qt and VTK bring eighty libraries.
#include "Explica/Core/Errors.h"
#include "Explica/Viewer/Window.h"

#include <dlfcn.h>

#include <filesystem>

namespace explica::viewer {
namespace {

namespace fs = std::filesystem;
using ShowWindow = void (*)(Session&, const WindowCalls&, const WindowOptions&);

constexpr const char* kWithout = "; --screenshot and --film draw without a window";  // what to do

/// Beside the program, as installing and building place them.
fs::path windowFile() {
  return (fs::read_symlink("/proc/self/exe").parent_path() / EXPLICA_WINDOW_FROM_PROGRAM)
      .lexically_normal();
}

ShowWindow loadWindow() {
  const fs::path file = windowFile();
  if (!fs::exists(file)) {
    throw EnvironmentError(file.string() +
                           ": the window is not installed; install Debian's package "
                           "explica-window, or build with Qt 5 and VTK's Qt widget" +
                           kWithout);
  }
  void* const library = dlopen(file.c_str(), RTLD_NOW);
  void* const show = library ? dlsym(library, "explicaShowWindow") : nullptr;
  if (!show) {
    throw EnvironmentError("the window could not be loaded: " + std::string(dlerror()) + kWithout);
  }
  return reinterpret_cast<ShowWindow>(show);
}

}  // namespace

void showWindow(Session& session, const WindowCalls& calls, const WindowOptions& options) {
  loadWindow()(session, calls, options);
}

}  // namespace explica::viewer
