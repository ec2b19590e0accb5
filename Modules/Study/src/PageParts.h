// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::study {

// Texts that the build packs into the library.
extern const char* const kStudyStyle;
extern const char* const kStudyScript;

}  // namespace explica::study
