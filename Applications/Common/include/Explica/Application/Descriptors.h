// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Declaration.h"

#include <string>

namespace explica::app {

// What other tools read of the commands, from their declarations.

[[nodiscard]] std::string bashCompletion();
[[nodiscard]] std::string zshCompletion();

/// "explica-study-group".
[[nodiscard]] std::string manPageName(const std::string& command);
/// Manual page, section 1, in roff.
[[nodiscard]] std::string manPageOf(const Declaration& declaration);

/// The manual page of `explica` itself: its commands.
[[nodiscard]] std::string overviewManPage();

}  // namespace explica::app
