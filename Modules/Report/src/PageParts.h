// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::report {

// Texts that the build packs into the library: our style and script, and the 3D library of the
// system.
extern const char* const kPageStyle;
extern const char* const kPageScript;
extern const char* const kThreeScript;

}  // namespace explica::report
