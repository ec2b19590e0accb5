// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/VertexDataFile.h"
#include "Explica/Viewer/Session.h"

#include <functional>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace explica::viewer {

/// Values on the surface's vertices that the window can show beside its own maps (region, flux,
/// seen share, area ratio); not-a-number where not known.
struct WindowMap : io::VertexMap {
  std::string file = {};  ///< for `explica unfold --map`: the file whose first map this is
};

/// Labels on the surface's vertices.
struct WindowLabels : io::LabelMap {
  std::string file = {};  ///< for `explica unfold --label`
};

/// What a file holds that the user opens.
struct Opened {
  std::string what;  ///< for the status line: "thickness.shape.gii: 1 map"
  std::vector<WindowMap> maps;
  std::vector<WindowLabels> labels;
  std::optional<Finished> finished;
};
/// Opens a file or folder for the window's surface; throws Error with a sentence for the user.
using OpenFile = std::function<Opened(const std::string& path)>;

/// Saves a state; the text, shown when it is there, says what came of it.
using Save = std::function<std::future<std::string>(const Session& session, std::size_t moment)>;

/// What the window asks for from outside, since it reads and writes nothing itself.
struct WindowCalls {
  OpenFile open;
  Save save;
};

struct WindowOptions {
  int width = 1400;  ///< pixels
  int height = 900;  ///< pixels
  std::string title = "Explica";
  std::string surface;  ///< its file, for the command that reproduces a state
  /// Options of `explica unfold` by which that file was read.
  std::vector<std::pair<std::string, std::string>> reading = {};
  std::vector<Opened> opened;         ///< at the start
  std::optional<std::string> script;  ///< file of events to play; the window then closes
};

/// Opens a window on a session and returns when it is closed.
///
/// Left drag rotates, right drag zooms, middle drag pans.  Everything that can be done stands in
/// the menus with its key, and F1 lists the keys.  While iterations run in the session's thread,
/// the picture follows and can be turned; they stop where `explica unfold` would stop.
///
/// A script has one event a line, for tests and demonstrations; positions are pixels of the
/// three-dimensional view from its lower left: `key KEY X Y` (space, Left, c, ...), `drag X0 Y0 X1
/// Y1`, `turn PICTURES`, `do ACTION` (the name of a menu's action), `set PANEL_FIELD VALUE`, `open
/// FILE`, `wait N` (until N states exist or nothing runs), `saved` (until saving is over),
/// `picture FILE.png`.
///
/// Defined in the library Explica::Window, which needs Qt and VTK; the rest of the module does not.
///
/// @throws InvalidInput      a line of the script that is none of these
/// @throws EnvironmentError  no display, or none that answers
void showWindow(Session& session, const WindowCalls& calls, const WindowOptions& options = {});

}  // namespace explica::viewer
