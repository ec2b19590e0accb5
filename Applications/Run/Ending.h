// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace explica::app {

/// What came out of a run, a line each: thickness of each hemisphere, each patch (where it is, how
/// much of it is seen, what that cost).  Nothing of steps that were not done.
/// @param out  the run's folder, with the summaries and records of its steps
[[nodiscard]] std::vector<std::string> whatCameOut(const std::filesystem::path& out);

}  // namespace explica::app
