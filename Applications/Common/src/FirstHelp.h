// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace explica::app {

/// What a command says of itself at first, by --help and completion; --help-all says the rest.
struct FirstHelp {
  std::string_view command;
  std::vector<std::string_view> options;  ///< those that most people need: about a dozen
  std::string_view last;                  ///< last lines of the example
  std::string_view before = {};           ///< and what precedes them

  /// Lines that work as pasted into an empty folder.
  [[nodiscard]] std::string example() const { return std::string(before) + std::string(last); }
};

/// The row of a command, or nullptr.
[[nodiscard]] const FirstHelp* firstHelpOf(std::string_view command);

/// Every row, for tests.
[[nodiscard]] const std::vector<FirstHelp>& allFirstHelp();

}  // namespace explica::app
