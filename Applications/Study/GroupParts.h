// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Statistics/GroupMaps.h"
#include "GroupStage.h"
#include "KeptRun.h"

#include <array>

namespace explica::app {

inline constexpr std::array kMeasures = {"thickness", "sulc", "area"};
inline constexpr std::size_t kThickness = 0;  // among them
inline constexpr std::array kUnits = {"mm", "mm", "mm^2"};

/// A hemisphere that is on the template.
struct Member {
  study::StudyRow* row = nullptr;
  std::filesystem::path run;
  TemplateMaps maps;
  std::string reason;  ///< why it is left out; empty: in the group

  [[nodiscard]] std::string stem() const {
    return row->participant + "_hemi-" + row->hemisphere + "_" + maps.entity;
  }
  [[nodiscard]] std::string label() const { return row->participant + "_hemi-" + row->hemisphere; }
};

/// A side of the group: its surfaces, and mean and deviation of each measure.
struct GroupSide {
  std::string hemisphere;
  Eigen::Index vertices = 0;
  std::optional<TriangleMesh> surface;  ///< the template's middle surface; none if it has none
  std::optional<io::LabelMap> regions;  ///< the template's; none if it has none
  std::vector<statistics::GroupMaps> groups;  ///< of each measure
  Eigen::Index people = 0;
};

/// Without the session: as participants.tsv has it.
[[nodiscard]] std::string personOf(const study::StudyRow& row);
[[nodiscard]] std::string structureOf(const std::string& hemisphere);

/// A person's map; NaN where the thickness is not known.
[[nodiscard]] Eigen::VectorXd readMap(const Member& member, std::size_t measure,
                                      std::optional<Eigen::Index> count);

/// Mean and deviation over those who are in the group.
[[nodiscard]] GroupSide gather(Context& context, const std::vector<Member>& members,
                               const std::string& hemisphere);
void writeSide(Context& context, const GroupSide& side, const std::string& entity);
/// A person's z-maps, and what they come to.
void compare(Context& context, const Member& member, const GroupSide& side);
/// Mean and deviation of the thickness on the inflated surface, both sides of each hemisphere.
void drawGroup(Context& context, const std::vector<GroupSide>& sides);

/// Names of what is known of people, and the cells of one of them.
[[nodiscard]] std::vector<std::string> columnsOf(const AboutPeople& about);
[[nodiscard]] std::string cellsOf(const AboutPeople& about, const std::vector<std::string>& columns,
                                  const std::string& person);

/// Fits the model to the smoothed thickness of people with all sides.
void fitModel(Context& context, const GroupSettings& s, const std::vector<Member>& members,
              const std::vector<GroupSide>& sides, const AboutPeople& about,
              const std::string& entity);

}  // namespace explica::app
