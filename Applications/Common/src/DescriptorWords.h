// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Descriptors.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace explica::app {

// What the formats for other tools share: questions about a parameter of a declaration, as JSON.

inline constexpr std::array<std::pair<int, const char*>, 5> kExitCodes = {
    {{0, "done"},
     {1, "usage"},
     {2, "bad input"},
     {3, "a goal or check was missed (results written and marked)"},
     {4, "environment"}}};

[[nodiscard]] std::string replaced(std::string text, const std::string& from,
                                   const std::string& to);
[[nodiscard]] bool takesFile(const Json& p);
[[nodiscard]] bool takesFolder(const Json& p);
[[nodiscard]] bool isFlag(const Json& p);
[[nodiscard]] std::string word(const Json& value);
/// Help with unit, as one sentence.
[[nodiscard]] std::string helpOf(const Json& p);
/// The same with the default.
[[nodiscard]] std::string helpWithDefault(const Json& p);
[[nodiscard]] std::vector<std::string> categoriesOf(const Json& command);

}  // namespace explica::app
