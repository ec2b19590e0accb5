// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace explica::app {

/// An option that had another name up to version 0.1.
struct Renamed {
  std::string_view command, before, now;
};

inline constexpr std::array kRenamed = {
    Renamed{"bids", "hemispheres", "hemisphere"},  Renamed{"embed", "centre", "center"},
    Renamed{"embed", "grid", "cells"},             Renamed{"embed", "label", "label-key"},
    Renamed{"heart", "frames", "phases"},          Renamed{"polygon", "label", "label-key"},
    Renamed{"study hearts", "frames", "phases"},   Renamed{"surface", "grey", "grey-label"},
    Renamed{"surface", "white", "white-label"},    Renamed{"thickness", "grid", "cells"}};

/// The present name of a command's option, or of the option of one of its steps as
/// "surface.white"; empty if it has not been renamed.
inline std::string nowCalled(std::string_view command, std::string_view option) {
  for (const Renamed& renamed : kRenamed) {
    if (command == renamed.command && option == renamed.before) return std::string(renamed.now);
    const std::string step = std::string(renamed.command) + ".";
    if (option == step + std::string(renamed.before)) return step + std::string(renamed.now);
  }
  return "";
}

}  // namespace explica::app
