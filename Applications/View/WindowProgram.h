// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace explica::app {

/// Goes on as the program explica-window with this process's own arguments.  It stands where
/// installing and building place it, relative to `explica`; only it loads Qt and VTK.
/// @throws EnvironmentError  it is not installed, or cannot be started
[[noreturn]] void startWindowProgram();

/// The program `explica`, as explica-window finds it.
[[nodiscard]] std::filesystem::path mainProgram();

}  // namespace explica::app
