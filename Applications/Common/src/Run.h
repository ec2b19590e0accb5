// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Console.h"
#include "Explica/Application/Execute.h"

#include <set>
#include <string>
#include <vector>

namespace explica::app {

/// One run of a command whose values are set.
struct Run {
  Invocation invocation;
  CommonOptions common;
  std::set<std::string> given;      ///< names that the user set
  std::vector<std::string> argv;    ///< for the record
  const Monitor* parent = nullptr;  ///< of the command that this one is a step of
  std::string name;                 ///< as a step of the parent: "unfold: "
  std::string prefix;               ///< starts its messages: the names of all above and its own
};

/// Checks inputs and output folder, runs, writes summary and record, and makes the results appear.
/// Bad input and the like leave nothing behind and reach the caller as exceptions.
Outcome execute(Run& run, Console& console);

}  // namespace explica::app
