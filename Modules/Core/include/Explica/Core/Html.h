// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace explica {

/// Text as it may stand in HTML and SVG, attributes too: &, <, >, both quotes replaced.
[[nodiscard]] std::string escapeHtml(std::string_view text);

}  // namespace explica
