// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace explica::testing {

/// A volume file that no command can use.
struct BadVolume {
  std::string name;                                   ///< of the case
  std::string file;                                   ///< name of the file, with extension
  std::function<void(const std::string& path)> make;  ///< writes it (or does not)
  std::vector<std::string> message;                   ///< what the sentence must hold
};

inline void PrintTo(const BadVolume& volume, std::ostream* stream) {
  *stream << volume.name;
}

/// Missing, truncated, not an image, 2D, 4D, all zero, NaN, sheared, contradictory, a folder.
[[nodiscard]] const std::vector<BadVolume>& badVolumes();

}  // namespace explica::testing
