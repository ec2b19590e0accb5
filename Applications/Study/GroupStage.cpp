// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GroupStage.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Html.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Study/StudyPage.h"
#include "Explica/Study/StudyTable.h"
#include "GroupParts.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace explica::app {

std::string personOf(const study::StudyRow& row) {
  return row.participant.substr(0, row.participant.find("_ses-"));
}

std::string structureOf(const std::string& hemisphere) {
  return hemisphere == "R" ? "CortexRight" : "CortexLeft";
}

std::vector<std::string> columnsOf(const AboutPeople& about) {
  std::set<std::string> names;
  for (const auto& [person, columns] : about) {
    for (const auto& [name, value] : columns) names.insert(name);
  }
  return {names.begin(), names.end()};
}

std::string cellsOf(const AboutPeople& about, const std::vector<std::string>& columns,
                    const std::string& person) {
  const auto row = about.find(person);
  std::string cells;
  for (const std::string& column : columns) {
    const bool known = row != about.end() && row->second.count(column) != 0;
    cells += "\t" + (known ? row->second.at(column) : "n/a");
  }
  return cells;
}

namespace {

namespace fs = std::filesystem;

std::string labelOf(const study::StudyRow& row) {
  return row.participant + "_hemi-" + row.hemisphere;
}

bool isNamed(const std::vector<std::string>& names, const study::StudyRow& row) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    const std::string full = name.starts_with("sub-") ? name : "sub-" + name;
    return full == row.participant || full == personOf(row) || full == labelOf(row);
  });
}

/// Every hemisphere once, with the reason to leave it out.
std::vector<Member> membersOf(const fs::path& out, const GroupSettings& s,
                              std::vector<study::StudyRow>& rows) {
  std::vector<Member> members;
  std::set<std::string> known;
  for (study::StudyRow& row : rows) {
    if (!known.insert(labelOf(row)).second) continue;  // another region of the same surfaces
    Member member{&row, out / "runs" / labelOf(row), {}, ""};
    if (!row.region.empty()) member.run += "_region-" + row.region;
    member.maps = templateMapsOf(member.run);
    const bool asked = isNamed(s.include, row);
    if (member.maps.entity.empty()) {
      member.reason = row.state == "done" ? "it is not registered to a template" : row.state;
    } else if (row.state != "done" && !asked) {
      member.reason = row.state;
    }
    members.push_back(std::move(member));
  }
  for (const std::string& name : s.include) {
    const bool there = std::any_of(
        rows.begin(), rows.end(), [&](const study::StudyRow& row) { return isNamed({name}, row); });
    if (!there) throw InvalidInput("include: there is no " + name + " among the study's people");
  }
  return members;
}

/// The template and density that all have.
std::string commonEntity(const std::vector<Member>& members) {
  const Member* first = nullptr;
  for (const Member& member : members) {
    if (member.maps.entity.empty()) continue;
    if (first == nullptr) first = &member;
    if (member.maps.entity == first->maps.entity) continue;
    throw InvalidInput(labelOf(*member.row) + " is on " + member.maps.entity + ", " +
                       labelOf(*first->row) + " on " + first->maps.entity +
                       "; do one of them again with the other's --template and --resample.to");
  }
  return first == nullptr ? "" : first->maps.entity;
}

std::string headOf(const std::vector<std::string>& columns) {
  std::string head;
  for (const std::string& column : columns) head += "\t" + column;
  return head + "\n";
}

std::string peopleTable(const std::vector<Member>& members, const AboutPeople& about) {
  const auto columns = columnsOf(about);
  std::string text = "participant_id\themisphere\tin_group\treason";
  for (const char* measure : kMeasures) text += std::string("\tdistance_") + measure;
  text += headOf(columns);
  for (const Member& member : members) {
    const study::StudyRow& row = *member.row;
    text += row.participant + "\t" + row.hemisphere + "\t" +
            (member.reason.empty() ? "yes" : "no") + "\t" +
            (member.reason.empty()
                 ? row.state == "done" ? "n/a" : "included: " + study::cellText(row.state)
                 : study::cellText(member.reason));
    for (const char* measure : kMeasures) {
      text += "\t" + study::valueIn(row, std::string("group.distance_") + measure);
    }
    text += cellsOf(about, columns, personOf(row)) + "\n";
  }
  return text;
}

/// The runs' tables of regions, one below the other.
std::string regionTable(const std::vector<Member>& members, const AboutPeople& about) {
  const auto columns = columnsOf(about);
  std::string text =
      "participant_id\themisphere\tatlas\tregion\tmeasure\tvalue\tunit\tin_group" + headOf(columns);
  for (const Member& member : members) {
    std::istringstream table(study::accountOf(member.run).value("regions", std::string()));
    std::string line;
    std::getline(table, line);
    const std::string after = std::string("\t") + (member.reason.empty() ? "yes" : "no") +
                              cellsOf(about, columns, personOf(*member.row)) + "\n";
    while (std::getline(table, line)) {
      text += member.row->participant + line.substr(std::min(line.find('\t'), line.size())) + after;
    }
  }
  return text;
}

std::string pagePart(const GroupSummary& group, const std::vector<GroupSide>& sides,
                     bool modelled) {
  std::string html = "<section id=\"group\"><h2>Together on the template</h2>\n<p>" +
                     std::to_string(group.in.size()) + " hemispheres are in the group's numbers, " +
                     std::to_string(group.out.size()) +
                     " are left out. Space: " + escapeHtml(group.space) +
                     ". Each one's distance from the others is in the table (1 is typical).</p>\n";
  if (!group.out.empty()) {
    html += "<ul>";
    for (const std::string& one : group.out) html += "<li>" + escapeHtml(one) + "</li>";
    html += "</ul>\n";
  }
  for (const GroupSide& side : sides) {
    if (!side.surface) continue;
    for (const char* what : {"mean", "deviation"}) {
      if (side.people < 2 && std::string(what) == "deviation") continue;
      html += "<figure><img loading=\"lazy\" src=\"group/hemi-" + side.hemisphere + "_" + what +
              ".png\" alt=\"thickness, " + what + "\"><figcaption>Thickness, " + what + ", " +
              (side.hemisphere == "L" ? "left" : "right") + " hemisphere, " +
              std::to_string(side.people) + " people</figcaption></figure>\n";
    }
  }
  if (modelled) html += "<p><a href=\"group/glm/report.html\">The model's results</a></p>\n";
  return html + "</section>\n";
}

/// The group, and a part of the study's page.
std::string writeGroup(Context& context, const GroupSettings& s, const AboutPeople& about,
                       std::vector<study::StudyRow>& rows) {
  std::vector<Member> members = membersOf(context.outputFolder(), s, rows);
  GroupSummary summary;
  summary.space = commonEntity(members);
  if (summary.space.empty() && s.model) {
    throw InvalidInput("--model: nobody is registered to a template; the step register does so");
  }
  for (study::StudyRow& row : rows) {
    if (const auto known = about.find(personOf(row)); known != about.end()) {
      for (const auto& [name, value] : known->second) row.values["participant." + name] = value;
    }
  }
  if (summary.space.empty()) return "";
  auto step = context.step("group");
  std::set<std::string> hemispheres;
  for (const Member& member : members) {
    const std::string label = labelOf(*member.row);
    member.reason.empty() ? summary.in.push_back(label)
                          : summary.out.push_back(label + ": " + study::cellText(member.reason));
    if (member.reason.empty()) hemispheres.insert(member.row->hemisphere);
  }
  std::vector<GroupSide> sides;
  for (const std::string& hemisphere : hemispheres) {
    sides.push_back(gather(context, members, hemisphere));
    writeSide(context, sides.back(), summary.space);
    for (const Member& member : members) {
      if (member.row->hemisphere != hemisphere || member.maps.entity.empty()) continue;
      checkpoint();
      compare(context, member, sides.back());
    }
  }
  writeTextFile(context.output("group/people.tsv"), peopleTable(members, about));
  writeTextFile(context.output("group/regions.tsv"), regionTable(members, about));
  drawGroup(context, sides);
  context.dropCommand("group/glm");  // an earlier model's
  if (s.model) fitModel(context, s, members, sides, about, summary.space);
  context.results(summary);
  for (const std::string& one : summary.out) context.warn("left out of the group: " + one);
  return pagePart(summary, sides, s.model.has_value());
}

}  // namespace

void describe(Results& t, const GroupSummary& g) {
  t.count("hemispheres_in_group", "Hemispheres in the group", "Those that the means are of.",
          static_cast<std::int64_t>(g.in.size()))
      .inHead();
  t.count("hemispheres_left_out", "Hemispheres left out",
          "Failed, doubted and not included by name, or not on the template.",
          static_cast<std::int64_t>(g.out.size()))
      .inHead();
  t.words("left_out", "Who is left out", "With the reason.", g.out);
  t.text("space", "Space and density", "Of the group's maps.", g.space);
}

void declareGroup(Declaration& d, GroupSettings& s) {
  d.category("Group")
      .option("include", "people who count although their run is doubted, with or without sub-",
              s.include)
      .option("model",
              "formula as of glm, with the columns of participants.tsv: fitted to the "
              "smoothed thickness, into group/glm",
              s.model)
      .option({"fwhm", "mm", "smoothing of the maps for --model", kAboveZero, 100}, s.fwhm)
      .results<GroupSummary>()
      .output("group/*", FileKind::Any,
              "means, deviations and z-maps on the template, tables of people and regions")
      .output("group/glm", FileKind::Folder, "with --model: what `explica glm` writes");
}

void writeStudy(Context& context, const GroupSettings& settings, const AboutPeople& about,
                std::vector<study::StudyRow>& rows, const std::string& title) {
  const std::string part = writeGroup(context, settings, about, rows);
  writeTextFile(context.output("study.tsv"), study::tableText(rows));
  writeTextFile(context.output("study_regions.tsv"), study::regionsText(rows));
  writeTextFile(context.output("study_internals.tsv"), study::internalsText(rows));
  writeTextFile(context.output("index.html"), study::indexPage(rows, title, part));
}

}  // namespace explica::app
