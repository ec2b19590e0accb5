// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace explica::app {

/// An option that had another name up to version 0.1.
struct Renamed {
  std::string_view command, before, now;
};

inline constexpr std::array kRenamed = {Renamed{"bids", "hemispheres", "hemisphere"},
                                        Renamed{"embed", "centre", "center"},
                                        Renamed{"embed", "grid", "cells"},
                                        Renamed{"embed", "label", "label-key"},
                                        Renamed{"heart", "frames", "phases"},
                                        Renamed{"polygon", "label", "label-key"},
                                        Renamed{"study hearts", "frames", "phases"},
                                        Renamed{"surface", "grey", "grey-label"},
                                        Renamed{"surface", "white", "white-label"},
                                        Renamed{"thickness", "grid", "cells"}};

/// The present name, among those that are `known`, of an option or of that of a step as
/// "surface.white"; empty if there is none.
inline std::string nowCalled(std::string_view option, const std::vector<std::string>& known) {
  for (const Renamed& renamed : kRenamed) {
    const std::string step = std::string(renamed.command) + ".";
    for (const std::string& before : {std::string(), step}) {
      const std::string now = before + std::string(renamed.now);
      const bool isKnown = std::find(known.begin(), known.end(), now) != known.end();
      if (isKnown && option == before + std::string(renamed.before)) return now;
    }
  }
  return "";
}

}  // namespace explica::app
