// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Viewer/Session.h"

#include <array>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

namespace explica::viewer {

/// Values on the surface's vertices that the window can show beside its own maps (region, flux,
/// seen share, area ratio).
struct WindowMap {
  std::string name;        ///< with its unit
  Eigen::VectorXd values;  ///< V
};

using Rgb = std::array<unsigned char, 3>;

/// Colours of a map's values, one a vertex.
using Paint =
    std::function<std::vector<Rgb>(const std::string& name, const Eigen::VectorXd& values)>;

struct WindowOptions {
  int width = 1400;  ///< pixels
  int height = 900;  ///< pixels
  std::string title = "Explica";
  std::vector<WindowMap> maps;        ///< shown in turn after the window's own
  std::optional<std::string> script;  ///< file of events to play; the window then closes
};

/// Saves a state; the text, shown when it is there, says what came of it.
using Save = std::function<std::future<std::string>(const Session& session, std::size_t moment)>;

/// Opens a window on a session and returns when it is closed.
///
/// Left drag rotates, right drag zooms, middle drag pans.  Keys: c picks the region's centre under
/// the pointer, v makes the present view the viewpoint, space runs and pauses, left and right step
/// through the states, home and end go to the first and last, m goes to the next map, r resets, w
/// saves, h shows the keys, q closes.  Sliders set the radius and the state.  While iterations run
/// in the session's thread, the picture follows and can be turned.
///
/// A script has one event a line, for tests and demonstrations; positions are pixels from the lower
/// left: `key KEY X Y` (space, Left, c, ...), `drag X0 Y0 X1 Y1`, `wait N` (until N states exist or
/// nothing runs), `saved` (until saving is over), `picture FILE.png`.
///
/// @param paint  colours of a map
/// @param save   called on w with the state shown
/// @throws InvalidInput      a line of the script that is none of these
/// @throws EnvironmentError  no display, or none that answers
void showWindow(Session& session, const Paint& paint, const Save& save,
                const WindowOptions& options = {});

}  // namespace explica::viewer
