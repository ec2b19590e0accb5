// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GroupStage.h"

#include "Explica/Application/CortexTemplate.h"
#include "Explica/Application/Execute.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Html.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Maps/Icosphere.h"
#include "Explica/Maps/Resampling.h"
#include "Explica/Maps/Smoothing.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Report/Figure.h"
#include "Explica/Statistics/GroupMaps.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>
#include <sstream>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;
using statistics::GroupMaps;

constexpr std::array kMeasures = {"thickness", "sulc", "area"};
constexpr std::size_t kThickness = 0;  // among them
constexpr std::array kUnits = {"mm", "mm", "mm^2"};
constexpr std::size_t kSmoothedAtOnce = 256;  // people; bounds memory

/// A hemisphere that is on the template.
struct Member {
  study::StudyRow* row = nullptr;
  fs::path run;
  std::string entity;  ///< "space-colin27_den-10k"
  std::string reason;  ///< why it is left out; empty: in the group

  [[nodiscard]] fs::path map(std::size_t measure) const {
    return run / "resample" / (kMeasures[measure] + ("_" + entity) + ".shape.gii");
  }
  [[nodiscard]] std::string stem() const {
    return row->participant + "_hemi-" + row->hemisphere + "_" + entity;
  }
};

std::string labelOf(const study::StudyRow& row) {
  return row.participant + "_hemi-" + row.hemisphere;
}

/// Without the session: as participants.tsv has it.
std::string personOf(const study::StudyRow& row) {
  return row.participant.substr(0, row.participant.find("_ses-"));
}

/// "space-X_den-Y" of the maps that a run has left; empty if there are none.
std::string entityIn(const fs::path& folder) {
  const std::string begin = std::string(kMeasures[0]) + "_space-", end = ".shape.gii";
  std::set<std::string> found;
  std::error_code fault;
  for (const auto& entry : fs::directory_iterator(folder, fault)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin) || !name.ends_with(end)) continue;
    const std::size_t from = std::string(kMeasures[0]).size() + 1;
    found.insert(name.substr(from, name.size() - from - end.size()));
  }
  return found.empty() ? "" : *found.begin();
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
    Member member{&row, out / "runs" / labelOf(row), "", ""};
    if (!row.region.empty()) member.run += "_region-" + row.region;
    member.entity = entityIn(member.run / "resample");
    const bool asked = isNamed(s.include, row);
    if (member.entity.empty()) {
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
    if (member.entity.empty()) continue;
    if (first == nullptr) first = &member;
    if (member.entity == first->entity) continue;
    throw InvalidInput(labelOf(*member.row) + " is on " + member.entity + ", " +
                       labelOf(*first->row) + " on " + first->entity +
                       "; do one of them again with the other's --template and --resample.to");
  }
  return first == nullptr ? "" : first->entity;
}

/// A person's map: the first of its file (the thickness; the white surface's area); NaN where the
/// thickness is not known.
Eigen::VectorXd readMap(const Member& member, std::size_t measure,
                        std::optional<Eigen::Index> count) {
  Eigen::VectorXd values = io::readVertexMaps(member.map(measure), count).front().values;
  // A thickness of 0 was not measured, as on the medial wall.
  if (measure == kThickness) values = (values.array() > 0).select(values, kNaN);
  return values;
}

std::string structureOf(const std::string& hemisphere) {
  return hemisphere == "R" ? "CortexRight" : "CortexLeft";
}

/// The template's middle surface at the maps' vertices; none where it has no surfaces.
std::optional<TriangleMesh> templateSurface(Context& context, const std::vector<Member>& members,
                                            const std::string& hemisphere, Eigen::Index vertices) {
  int level = 0;
  while (level < 7 && 10 * (Eigen::Index{1} << (2 * level)) + 2 < vertices) ++level;
  const auto member = std::find_if(members.begin(), members.end(), [&](const Member& m) {
    return m.row->hemisphere == hemisphere && !m.entity.empty();
  });
  const TriangleMesh sphere = maps::fsaverageSphere(level);
  if (sphere.vertexCount() != vertices) return {};
  const Json record = provenance::readRecord(member->run / "register" / provenance::kRecordName);
  const Json& name = record["options"]["template"];
  const CortexTemplate known =
      findTemplate(context, name.is_string() ? name.get<std::string>() : kDefaultTemplate,
                   structureOf(hemisphere));
  if (known.white.empty() || known.pial.empty()) return {};
  io::SurfaceReadOptions reading;
  reading.space = io::SurfaceSpace::Scanner;
  const auto read = [&](const std::string& file) {
    return io::readSurface(context.input(file, "template"), reading).mesh;
  };
  const TriangleMesh from = read(known.sphere), white = read(known.white);
  const auto weights =
      maps::resamplingWeights(from, sphere, maps::ResamplingMethod::Barycentric,
                              geometry::vertexAreas(from), geometry::vertexAreas(sphere));
  const Positions middle = 0.5 * (white.positions + read(known.pial).positions);
  return TriangleMesh{maps::resampleMaps(weights, middle), sphere.faces};
}

/// A side of the group: its surface, and mean and deviation of each measure.
struct Side {
  std::string hemisphere;
  Eigen::Index vertices = 0;
  std::optional<TriangleMesh> surface;
  std::vector<GroupMaps> groups;  ///< of each measure
  Eigen::Index people = 0;
};

Side gather(Context& context, const std::vector<Member>& members, const std::string& hemisphere) {
  Side side;
  side.hemisphere = hemisphere;
  const Member* first = nullptr;
  for (const Member& member : members) {
    if (member.row->hemisphere != hemisphere || !member.reason.empty()) continue;
    checkpoint(context.monitor());
    for (std::size_t m = 0; m < kMeasures.size(); ++m) {
      const Eigen::VectorXd map = readMap(member, m, {});
      if (first == nullptr) {
        first = &member;
        side.vertices = map.size();
      }
      if (map.size() != side.vertices) {
        throw InvalidInput(labelOf(*member.row) + ": " + kMeasures[m] + " has " +
                           std::to_string(map.size()) + " vertices, that of " +
                           labelOf(*first->row) + " " + std::to_string(side.vertices));
      }
      if (side.groups.size() == m) side.groups.emplace_back(side.vertices);
      side.groups[m].add(map);
    }
    ++side.people;
  }
  if (first != nullptr) {
    side.surface = templateSurface(context, members, hemisphere, side.vertices);
  }
  return side;
}

std::string number(double value) {
  if (!std::isfinite(value)) return "n/a";
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

void writeSide(Context& context, const Side& side, const std::string& entity) {
  const std::string stem = "group/hemi-" + side.hemisphere + "_" + entity + "_";
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    const GroupMaps& group = side.groups[m];
    io::writeGiftiShape(context.output(stem + kMeasures[m] + ".shape.gii"),
                        {{"mean", kUnits[m], group.mean()},
                         {"standard deviation", kUnits[m], group.deviation()},
                         {"coefficient of variation", "", group.variation()},
                         {"people", "", group.people()}},
                        structureOf(side.hemisphere));
  }
  if (!side.surface) return;
  io::SurfaceMetadata metadata;
  metadata.structure = structureOf(side.hemisphere);
  io::writeGiftiSurface(context.output(stem + "midthickness.surf.gii"), *side.surface, metadata);
}

/// A person's z-maps, and what they come to.
void compare(Context& context, const Member& member, const Side& side) {
  std::vector<io::VertexMap> maps;
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    const bool inGroup = member.reason.empty();
    const Eigen::VectorXd map = readMap(member, m, side.vertices);
    const Eigen::VectorXd z = side.groups[m].distance(map, inGroup);
    member.row->values[std::string("group.distance_") + kMeasures[m]] =
        number(statistics::typicalDistance(z, side.people - (inGroup ? 1 : 0)));
    maps.push_back({std::string("z of ") + kMeasures[m], "", z});
  }
  io::writeGiftiShape(context.output("group/" + member.stem() + "_desc-z.shape.gii"), maps,
                      structureOf(side.hemisphere));
}

std::vector<std::string> columnsOf(const AboutPeople& about) {
  std::set<std::string> names;
  for (const auto& [person, columns] : about) {
    for (const auto& [name, value] : columns) names.insert(name);
  }
  return {names.begin(), names.end()};
}

/// What is known of a person, as cells of a table.
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

std::string headOf(const std::vector<std::string>& columns) {
  std::string head;
  for (const std::string& column : columns) head += "\t" + column;
  return head + "\n";
}

std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  return text;
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
            (member.reason.empty() ? row.state == "done" ? "n/a" : "included: " + oneLine(row.state)
                                   : oneLine(member.reason));
    for (const char* measure : kMeasures) {
      const auto value = row.values.find(std::string("group.distance_") + measure);
      text += "\t" + (value == row.values.end() ? "n/a" : value->second);
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
    const fs::path file = member.run / "regions/regions.tsv";
    if (!fs::exists(file)) continue;
    std::istringstream table(fileText(file));
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

/// Mean and deviation of the thickness, both sides of each hemisphere.
void drawGroup(Context& context, const std::vector<Side>& sides) {
  for (const Side& side : sides) {
    if (!side.surface) continue;
    using report::ViewName;
    const bool left = side.hemisphere == "L";
    const std::vector<report::FigureView> views = {
        {left ? ViewName::Left : ViewName::Right, {}, {}, {}},
        {left ? ViewName::Right : ViewName::Left, {}, {}, {}}};
    const GroupMaps& thickness = side.groups.front();
    for (const bool mean : {true, false}) {
      report::SurfacePaint paint;
      paint.values = mean ? thickness.mean() : thickness.deviation();
      if (!(paint.values.array().isFinite().any())) continue;
      paint.scale = report::scaleFor(paint.values, mean ? "mean" : "standard deviation", "mm");
      report::SurfacePictureOptions size;
      size.width = 480;
      size.height = 360;
      report::writePng(context.output("group/hemi-" + side.hemisphere +
                                      (mean ? "_mean" : "_deviation") + ".png"),
                       report::surfaceFigure(*side.surface, paint, views, 2, size));
    }
  }
}

/// Fits the model to the smoothed thickness of people with all sides.
void fitModel(Context& context, const GroupSettings& s, const std::vector<Member>& members,
              const std::vector<Side>& sides, const AboutPeople& about, const std::string& entity) {
  std::map<std::string, std::map<std::string, const Member*>> people;
  for (const Member& member : members) {
    if (member.reason.empty()) people[member.row->participant][member.row->hemisphere] = &member;
  }
  std::erase_if(people, [&](const auto& person) { return person.second.size() < sides.size(); });
  for (const Side& side : sides) {
    if (!side.surface) {
      throw InvalidInput("--model: the template has no surfaces to smooth maps on");
    }
    std::vector<const Member*> all;
    for (const auto& [name, found] : people) all.push_back(found.at(side.hemisphere));
    for (std::size_t first = 0; first < all.size(); first += kSmoothedAtOnce) {
      const std::size_t count = std::min(kSmoothedAtOnce, all.size() - first);
      Eigen::MatrixXd maps(side.vertices, count);
      for (std::size_t n = 0; n < count; ++n) {
        maps.col(static_cast<Eigen::Index>(n)) = readMap(*all[first + n], 0, side.vertices);
      }
      maps = maps::smoothMaps(*side.surface, std::move(maps), s.fwhm, {}, context.monitor());
      for (std::size_t n = 0; n < count; ++n) {
        io::writeGiftiShape(
            context.output("group/" + all[first + n]->stem() + "_desc-smooth_thickness.shape.gii"),
            {{"thickness", "mm", maps.col(static_cast<Eigen::Index>(n))}},
            structureOf(side.hemisphere));
      }
    }
  }
  const auto columns = columnsOf(about);
  std::string list = "participant_id", table = "participant_id" + headOf(columns);
  for (const Side& side : sides) list += side.hemisphere == "L" ? "\tleft" : "\tright";
  list += "\n";
  for (const auto& [name, found] : people) {
    list += name;
    for (const Side& side : sides) {
      list += "\t" + found.at(side.hemisphere)->stem() + "_desc-smooth_thickness.shape.gii";
    }
    list += "\n";
    table += name + cellsOf(about, columns, personOf(*found.begin()->second->row)) + "\n";
  }
  writeTextFile(context.output("group/maps.tsv"), list);
  writeTextFile(context.output("group/participants.tsv"), table);
  Json surfaces = Json::array();
  for (const Side& side : sides) {
    surfaces.push_back(
        context.output("group/hemi-" + side.hemisphere + "_" + entity + "_midthickness.surf.gii")
            .string());
  }
  context.runCommand(*findCommand("glm"), "group/glm",
                     {{"maps", context.output("group/maps.tsv").string()},
                      {"table", context.output("group/participants.tsv").string()},
                      {"model", *s.model},
                      {"surface", surfaces}});
}

std::string pagePart(const GroupSummary& group, const std::vector<Side>& sides, bool modelled) {
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
  for (const Side& side : sides) {
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
  d.option("Group",
           Field{"include", "",
                 "people who count although their run is doubted, with or without "
                 "sub-"},
           s.include)
      .option("Group",
              Field{"model", "",
                    "formula as of glm, with the columns of participants.tsv: fitted to the "
                    "smoothed thickness, into group/glm"},
              s.model)
      .option("Group", Field{"fwhm", "mm", "smoothing of the maps for --model", kAboveZero, 100},
              s.fwhm)
      .results<GroupSummary>()
      .output("group/*", FileKind::Any,
              "means, deviations and z-maps on the template, tables of people and regions")
      .output("group/glm", FileKind::Folder, "with --model: what `explica glm` writes");
}

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
                          : summary.out.push_back(label + ": " + oneLine(member.reason));
    if (member.reason.empty()) hemispheres.insert(member.row->hemisphere);
  }
  std::vector<Side> sides;
  for (const std::string& hemisphere : hemispheres) {
    sides.push_back(gather(context, members, hemisphere));
    writeSide(context, sides.back(), summary.space);
    for (const Member& member : members) {
      if (member.row->hemisphere != hemisphere || member.entity.empty()) continue;
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

}  // namespace explica::app
