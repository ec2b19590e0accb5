// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Application/Declaration.h"

#include <string>
#include <string_view>
#include <vector>

namespace explica::app {

/// Declares --accept NAME.
void declareAccept(Declaration& d, std::vector<std::string>& accepted);

/// Compares a command's numbers with the limits of Segmentation/Plausibility.h.  What lies outside
/// is a warning, a row of `flags` in summary.json, and makes the exit code 3, unless its name is
/// among the accepted; `plausible` is then false.
class Judge {
 public:
  /// @throws UsageError  an accepted name that is no limit's
  Judge(Context& context, std::vector<std::string> accepted);

  /// For what makes further work pointless.
  /// @throws InvalidInput  the value lies outside and is not accepted
  void require(std::string_view name, double value);
  /// For what a reader must know.
  void flag(std::string_view name, double value);

 private:
  Context& context_;
  std::vector<std::string> accepted_;
};

}  // namespace explica::app
