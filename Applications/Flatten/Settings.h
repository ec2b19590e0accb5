// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/CortexFiles.h"
#include "Explica/Flattening/Cuts.h"
#include "Explica/Flattening/Flatten.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Unfolding/Region.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

constexpr const char* kAutomatic = "auto";       // of --cuts
constexpr const char* kOfTemplate = "template";  // of --cuts

/// What `explica flatten` is asked for.
struct FlattenSettings {
  std::string surface;
  io::SurfaceReadOptions reading;
  std::optional<std::string> reference;
  std::optional<std::string> cuts;
  std::optional<std::string> cortex;
  std::optional<std::string> templateName, sphere;  ///< of --cuts template
  std::vector<std::string> cutNames;                ///< of these; empty: all
  flattening::CutOptions cut;
  unfolding::RegionOptions region;
  std::vector<std::string> labels;
  std::vector<int> labelKeys;
  std::optional<double> areaTolerance;
  flattening::FlattenOptions flatten;
  double grid = 0.5;
  std::optional<int> depths;
  CortexFiles sheet;
  VolumePlace place;
  std::vector<std::string> volumes;
  bool nearest = false;
  std::vector<std::string> maps;
  std::vector<std::string> regions;
  bool resume = false;
};

}  // namespace explica::app
