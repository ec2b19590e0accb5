// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace explica::app {

/// What of a run stays once its group-level results are there.
enum class Keep {
  All,
  Group  ///< what `study group` and `bids ... group` read, the report and the record
};
constexpr auto enumWords(Keep) {
  return std::to_array<EnumWord<Keep>>({{Keep::All, "all"}, {Keep::Group, "group"}});
}

[[nodiscard]] inline Field keepField() {
  return {"keep", "",
          "all files of a run, or what the group's numbers need: four files a hemisphere at most"};
}

/// Leaves four files of a run at most: kept.json, its maps on the template as one file, report.html
/// and provenance.json.  A run that is not on a template stays as it is.
/// @param key  of what the results depend on
void keepForGroup(const std::filesystem::path& run, const std::string& key);

/// True if keepForGroup() was done with this key.
[[nodiscard]] bool isKept(const std::filesystem::path& run, const std::string& key);

/// Links those steps that another run of a person has made and this one has not; the run finds them
/// true by their content, or makes its own.  Of the same hemisphere those before the unfolding are
/// the same, of the other one a T1's segmentation is.
void shareSteps(const std::filesystem::path& made, const std::filesystem::path& run,
                bool sameHemisphere);

/// The maps on the template that a run has: the measure's own file, or the one for all of them.
struct TemplateMaps {
  std::string entity;  ///< "space-colin27_den-10k"; empty if there are none
  bool together = false;
};
[[nodiscard]] TemplateMaps templateMapsOf(const std::filesystem::path& run);

}  // namespace explica::app
