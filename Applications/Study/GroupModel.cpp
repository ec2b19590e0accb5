// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Execute.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Maps/Smoothing.h"
#include "Explica/Provenance/Json.h"
#include "GroupParts.h"

#include <algorithm>
#include <map>

namespace explica::app {
namespace {

using provenance::Json;
using People = std::map<std::string, std::map<std::string, const Member*>>;

constexpr std::size_t kSmoothedAtOnce = 256;  // people; bounds memory

std::string smoothName(const Member& member) {
  return member.stem() + "_desc-smooth_thickness.shape.gii";
}

/// Writes the people's smoothed maps of a side.
void smoothSide(Context& context, const GroupSide& side, const People& people, double fwhm) {
  if (!side.surface) {
    throw InvalidInput("--model: the template has no surfaces to smooth maps on");
  }
  std::vector<const Member*> all;
  for (const auto& [name, found] : people) all.push_back(found.at(side.hemisphere));
  for (std::size_t first = 0; first < all.size(); first += kSmoothedAtOnce) {
    const std::size_t count = std::min(kSmoothedAtOnce, all.size() - first);
    Eigen::MatrixXd maps(side.vertices, count);
    for (std::size_t n = 0; n < count; ++n) {
      maps.col(n) = readMap(*all[first + n], kThickness, side.vertices);
    }
    maps = maps::smoothMaps(*side.surface, std::move(maps), fwhm, {}, context.monitor());
    for (std::size_t n = 0; n < count; ++n) {
      io::writeGiftiShape(context.output("group/" + smoothName(*all[first + n])),
                          {{"thickness", "mm", maps.col(n)}}, structureOf(side.hemisphere));
    }
  }
}

/// The lists that glm reads: people's maps, and what is known of them with their reports.
void writeLists(Context& context, const std::vector<GroupSide>& sides, const People& people,
                const AboutPeople& about) {
  auto columns = columnsOf(about);
  std::erase(columns, "report");  // ours
  std::string list = "participant_id", table = "participant_id\treport";
  for (const GroupSide& side : sides) list += side.hemisphere == "L" ? "\tleft" : "\tright";
  for (const std::string& column : columns) table += "\t" + column;
  list += "\n";
  table += "\n";
  for (const auto& [name, found] : people) {
    list += name;
    for (const GroupSide& side : sides) list += "\t" + smoothName(*found.at(side.hemisphere));
    list += "\n";
    const study::StudyRow& row = *found.begin()->second->row;
    table += name + "\t" + (row.report.empty() ? "n/a" : "../../" + row.report.generic_string()) +
             cellsOf(about, columns, personOf(row)) + "\n";
  }
  writeTextFile(context.output("group/maps.tsv"), list);
  writeTextFile(context.output("group/participants.tsv"), table);
}

}  // namespace

/// Fits the model to the smoothed thickness of people with all sides.
void fitModel(Context& context, const GroupSettings& s, const std::vector<Member>& members,
              const std::vector<GroupSide>& sides, const AboutPeople& about,
              const std::string& entity) {
  People people;
  for (const Member& member : members) {
    if (member.reason.empty()) people[member.row->participant][member.row->hemisphere] = &member;
  }
  std::erase_if(people, [&](const auto& person) { return person.second.size() < sides.size(); });
  for (const GroupSide& side : sides) smoothSide(context, side, people, s.fwhm);
  writeLists(context, sides, people, about);
  Json surfaces = Json::array(), atlases = Json::array();
  for (const GroupSide& side : sides) {
    const std::string stem = "group/hemi-" + side.hemisphere + "_" + entity;
    surfaces.push_back(context.output(stem + "_midthickness.surf.gii").string());
    if (side.regions) atlases.push_back(context.output(stem + "_regions.label.gii").string());
  }
  Json options = {{"maps", context.output("group/maps.tsv").string()},
                  {"table", context.output("group/participants.tsv").string()},
                  {"model", *s.model},
                  {"surface", surfaces}};
  if (atlases.size() == surfaces.size()) options["atlas"] = atlases;
  context.runCommand(*findCommand("glm"), "group/glm", options);
}

}  // namespace explica::app
