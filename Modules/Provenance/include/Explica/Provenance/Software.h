// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Json.h"

#include <string>

namespace explica::provenance {

/// What was built: fixed when the program was compiled.
struct Software {
  std::string version;    ///< semantic version
  std::string commit;     ///< of the sources; "unknown" outside a git checkout
  bool dirty = false;     ///< sources differed from the commit
  std::string buildType;  ///< "Release"
  std::string compiler;   ///< name and version
};

[[nodiscard]] const Software& software();

/// "explica 0.1.0 (commit 1a2b3c4, with uncommitted changes)".
[[nodiscard]] std::string softwareText();

/// "built by GNU 12.2.0 (Release) with Eigen 3.4.0, ITK 5.2.1, ...".
[[nodiscard]] std::string builtWithText();

/// This machine: operating system, processor, memory; host and user unless `withNames` is false.
[[nodiscard]] Json describeMachine(bool withNames);

/// Names and versions of the libraries that the program was compiled with.
[[nodiscard]] Json describeLibraries();

}  // namespace explica::provenance
