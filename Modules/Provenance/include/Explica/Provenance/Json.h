// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Document.h"
#include "Explica/Provenance/Options.h"

#include <filesystem>
#include <string_view>

namespace explica::provenance {

/// An option's value: unset is null, points are arrays, infinities are "inf" and "-inf".
[[nodiscard]] Json valueOf(const Option& option);

/// Sets an option from JSON as valueOf() writes it; text as on the command line is accepted too.
/// @throws UsageError  names the option, what was found and what is expected
void setValue(Option& option, const Json& value);

/// {"unfold": {"radius": 30}} becomes {"unfold.radius": 30}.
[[nodiscard]] Json flattenKeys(const Json& object);

/// Writes a JSON file, whole or not at all, indented, ending in a newline; NaN becomes null.
/// @throws EnvironmentError  the file cannot be written
void writeJson(const std::filesystem::path& path, const Json& value);

/// Checks a value against a JSON schema (draft 7).
/// @return one sentence per fault, each with the place in the value; empty if valid
[[nodiscard]] std::vector<std::string> schemaFaults(const Json& value, std::string_view schema);

}  // namespace explica::provenance
