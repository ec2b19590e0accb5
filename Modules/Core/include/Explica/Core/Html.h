// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace explica {

/// Text as it may stand in HTML, SVG and XML, attributes too: some of &, <, >, both quotes
/// replaced.
[[nodiscard]] std::string escapeHtml(std::string_view text, std::string_view escaped = "&<>\"'");

/// JSON as it may stand in a script element.
[[nodiscard]] std::string scriptSafe(std::string json);

}  // namespace explica
