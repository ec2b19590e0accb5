// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::viewer {

/// Finds out whether a window can be opened before Qt does, which would end the program.
/// @throws EnvironmentError  no display, or none that answers
void requireDisplay();

}  // namespace explica::viewer
