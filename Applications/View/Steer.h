// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Core/Describe.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Unfolding/Unfolder.h"
#include "Explica/Viewer/Window.h"
#include "ShownSurface.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// How the interactive window starts, and where it saves.
struct SteerOptions {
  std::optional<int> vertex;
  double radius = 25;
  std::optional<double> distance;
  unfolding::Surround surround = unfolding::UnfolderOptions{}.surround;
  std::optional<double> targetVisibility;
  std::string save = "unfolded";
  std::optional<std::string> script;
};

template <class Visitor>
void describe(SteerOptions& o, Visitor&& visit) {
  visit(Field{"vertex", "", "centre of the region to start with"}, o.vertex);
  visit(Field{"radius", "mm", "of the region to start with"}, o.radius);
  visit(Field{"distance", "mm",
              "of the viewpoint from the region (default 1000, or three times the surface's extent "
              "if that is more)",
              kAboveZero},
        o.distance);
  visit(Field{"surround", "", "what becomes of the surface around the region"}, o.surround);
  visit(Field{"target-visibility", "", "stop there; else where it no longer pays"},
        o.targetVisibility);
  visit(Field{"save", "", "folder for saved states: each goes into iteration-N in it"}, o.save);
  visit(Field{"script", "", "file of events to play instead of waiting for the user's"}, o.script);
}

/// What shows the window: viewer::showWindow where there is one.
using ShowWindow =
    std::function<void(viewer::Session&, const viewer::WindowCalls&, const viewer::WindowOptions&)>;

/// Opens the window on a surface.  A saved state is what `explica unfold` writes when it runs with
/// the same choices: the same surfaces and maps, from a process of its own.
/// @param reading    how the surface was read
/// @param direction  from the surface to the viewer
/// @param opened     what else to show
void steer(Context& context, const ShownSurface& surface, const io::SurfaceReadOptions& reading,
           const Vector& direction, std::vector<viewer::Opened> opened, const SteerOptions& options,
           const ShowWindow& show);

}  // namespace explica::app
