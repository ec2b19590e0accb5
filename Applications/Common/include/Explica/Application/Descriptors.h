// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Json.h"

#include <string>

namespace explica::app {

using provenance::Json;

// Each function turns declarations, as `explica COMMAND --describe` prints them, into what another
// tool reads.  `version` is the software's.

[[nodiscard]] std::string bashCompletionOf(const Json& commands);
[[nodiscard]] std::string zshCompletionOf(const Json& commands);

/// Manual page, section 1, in roff.
[[nodiscard]] std::string manPageOf(const Json& command, const std::string& version);

/// The manual page of `explica` itself: its commands.
[[nodiscard]] std::string overviewManPageOf(const Json& commands, const std::string& version);

/// All declarations, in the order of their names.
[[nodiscard]] Json describeAllCommands();

}  // namespace explica::app
