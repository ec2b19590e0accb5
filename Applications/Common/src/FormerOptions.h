// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace explica::app {

/// An option that had another name, or was there, before version 0.1.
struct FormerOption {
  std::string_view command, before;
  std::string_view now;           ///< its present name; empty if it is gone
  std::string_view instead = {};  ///< what to use, of an option that is gone
};

inline constexpr char kTrade[] = "--trade weighs visibility against strain";
inline constexpr char kKept[] = "areas are always kept";
inline constexpr char kBetween[] = "--inner-radius and --outer-radius bound the annulus";
inline constexpr char kByPage[] = "ExampleData/thesis.sh computes the thesis's global flows";
inline constexpr char kByHeart[] = "explica heart has the segments of the left ventricle";

inline constexpr std::array kFormerOptions = std::to_array<FormerOption>(
    {{"bids", "hemispheres", "hemisphere"},
     {"embed", "annulus", "", kBetween},
     {"embed", "band", "", kBetween},
     {"embed", "centre", "center"},
     {"embed", "fit-step", "", "the fit finds its own steps (--max-iterations)"},
     {"embed", "grid", "cells"},
     {"embed", "label", "label-key"},
     {"heart", "frames", "phases"},
     {"inflate", "global-flow", "", kByPage},
     {"inflate", "global-measures", "", kByPage},
     {"polygon", "global-flow", "", kByPage},
     {"polygon", "label", "label-key"},
     {"polygon", "viewing-radius", "", kByPage},
     {"sample", "vertex-map", "", "explica resample brings maps to other surfaces"},
     {"sample", "vertex-surface", "", "explica resample brings maps to other surfaces"},
     {"study hearts", "frames", "phases"},
     {"surface", "grey", "grey-label"},
     {"surface", "white", "white-label"},
     {"thickness", "aha", "", kByHeart},
     {"thickness", "along", "", "explica sample --thickness tells layers by region"},
     {"thickness", "figure", "", "explica report has the slices"},
     {"thickness", "functions", "", "explica sample --thickness tells layers by region"},
     {"thickness", "grid", "cells"},
     {"thickness", "image-edge", "", "valid.nii.gz marks where the image's edge may matter"},
     {"thickness", "rv-insertion", "", kByHeart},
     {"unfold", "adjust-region", "", "another --radius or view makes the visibility positive"},
     {"unfold", "area-tolerance", "", kKept},
     {"unfold", "area-weight", "", kTrade},
     {"unfold", "atlas", "label"},
     {"unfold", "collar-weight", "", kTrade},
     {"unfold", "collar-width", "", "the collar is as wide as the region has to move"},
     {"unfold", "contact-range", "", kTrade},
     {"unfold", "contact-weight", "", kTrade},
     {"unfold", "guide-faces", "", kTrade},
     {"unfold", "guide-weight", "", kTrade},
     {"unfold", "keep-areas", "", kKept},
     {"unfold", "lift-weight", "", kTrade},
     {"unfold", "map", "label"},
     {"unfold", "max-time", "", "--max-time holds for the whole command"},
     {"unfold", "overhang-weight", "", kTrade},
     {"unfold", "region", "label-key"},
     {"unfold", "spring-weight", "", kTrade},
     {"unfold", "time-step", "", "the thesis's flow chooses its steps"},
     {"unfold", "view-weights", "", "name a viewpoint several times for more weight"},
     {"unfold", "yield-strain", "", kTrade}});

/// What became of a former option of a command, or of a step as "surface.white": "--grid is called
/// --cells now".  Empty if it never was one.
/// @param dashes  before each option's name: "--", or nothing in a file
inline std::string whatBecameOf(const std::string& option, std::string_view command,
                                const std::vector<std::string>& known, const std::string& dashes) {
  for (const FormerOption& former : kFormerOptions) {
    const std::string step = std::string(former.command) + ".";
    for (const std::string& prefix : {std::string(), step}) {
      if (option != prefix + std::string(former.before)) continue;
      const std::string now = prefix + std::string(former.now);
      if (std::find(known.begin(), known.end(), now) != known.end()) {
        return dashes + option + " is called " + dashes + now + " now";
      }
      if (former.now.empty() && (!prefix.empty() || command == former.command)) {
        return dashes + option + " is gone: " + std::string(former.instead);
      }
    }
  }
  return "";
}

}  // namespace explica::app
