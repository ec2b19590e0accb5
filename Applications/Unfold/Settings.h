// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Unfolding/Region.h"
#include "Explica/Unfolding/Unfold.h"
#include "View.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// What the options of `explica unfold` set.
struct UnfoldSettings {
  std::string surface;
  io::SurfaceReadOptions reading;
  ViewSettings view;
  std::optional<std::string> viewSurface;
  unfolding::RegionOptions region;
  std::vector<std::string> labels;
  std::vector<std::string> labelKeys;
  std::optional<double> above;
  bool repair = true;
  unfolding::UnfoldOptions unfold;
  bool resume = false;
};

void declareUnfold(Declaration& d, UnfoldSettings& s);

}  // namespace explica::app
