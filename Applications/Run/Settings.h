// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/Pipeline/Plan.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// What `explica run` is asked for.
struct RunSettings {
  std::string input;
  std::optional<std::string> atlas, t2;
  pipeline::PlanOptions plan;
  bool resume = false;
  std::vector<std::string> accept;
  std::vector<Invocation> steps;  ///< whose options are included, prefixed
};

void declareRun(Declaration& d, RunSettings& s);

}  // namespace explica::app
