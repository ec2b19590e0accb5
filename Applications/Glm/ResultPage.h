// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Results.h"

#include <string>

namespace explica::app {

/// A page on the results: what was tested, where, how sure, and how each person compares at the
/// peaks, where all values are in memory.
[[nodiscard]] std::string resultPage(const GlmSettings& settings, const Observations& observations,
                                     const GlmResults& results);

}  // namespace explica::app
