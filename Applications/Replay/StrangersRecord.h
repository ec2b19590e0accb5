// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Application/Declaration.h"
#include "Explica/Provenance/Json.h"

#include <filesystem>

namespace explica::app {

// A record may come from a stranger.  Replaying it must write below --out only, and read only the
// files that it names as its inputs.

/// @throws InvalidInput  a command that writes elsewhere, or that runs others' records
void requireConfined(const Declaration& declaration, const std::filesystem::path& recordPath);

/// The record's options and arguments as values for the command: inputs by where they are now, the
/// output folder of a positional argument replaced by `out`, nothing resumed.
/// @throws InvalidInput  a value that names a place outside `out`, or a file that is no input
[[nodiscard]] provenance::Json confinedValues(Context& context, Declaration& declaration,
                                              const provenance::Json& record,
                                              const std::filesystem::path& recordPath,
                                              const std::filesystem::path& out);

}  // namespace explica::app
