// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Observations.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/Types.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VertexFile.h"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using statistics::Table;

/// The column that names people: as asked for, or the first one.
std::size_t personColumn(const Table& table, const GlmSettings& s) {
  return table.find(s.person).value_or(0);
}

/// Files of each person, one for each hemisphere.
using MapFiles = std::vector<std::vector<fs::path>>;

std::vector<std::string> fileColumns(const Table& list) {
  if (list.find("file")) return {"file"};
  std::vector<std::string> columns = {"left", "right"};
  std::erase_if(columns, [&](const std::string& side) { return !list.find(side); });
  if (columns.empty()) {
    throw InvalidInput("'" + list.name +
                       "': a list of maps has a column file, or columns left and right");
  }
  return columns;
}

/// Paths in a list are relative to the list's folder.
MapFiles filesOf(const Table& list, const std::vector<std::size_t>& rows) {
  MapFiles files;
  const fs::path folder = fs::path(list.name).parent_path();
  for (const std::size_t row : rows) {
    files.emplace_back();
    for (const std::string& column : fileColumns(list)) {
      files.back().push_back(folder / list.rows[row][list.at(column)]);
    }
  }
  return files;
}

/// The map of a file: the only one, or that with the name of the model's response.
io::VertexMap mapIn(const fs::path& file, Eigen::Index vertices, const std::string& response) {
  auto maps = io::readVertexMaps(file, vertices);
  if (maps.size() == 1) return std::move(maps.front());
  const auto named = std::ranges::find(maps, response, &io::VertexMap::name);
  if (named != maps.end()) return std::move(*named);
  throw InvalidInput("'" + file.string() + "': holds " + std::to_string(maps.size()) + " maps (" +
                     joined(maps, ", ", [](const io::VertexMap& map) { return map.name; }) +
                     "); --model says by its left side which is meant");
}

/// Reads one person's maps one after the other.
void readMaps(const std::vector<fs::path>& files, const std::vector<MapSide>& hemispheres,
              const std::string& response, const std::vector<bool>& mask,
              std::span<double> values) {
  for (std::size_t h = 0; h < hemispheres.size(); ++h) {
    const io::VertexMap map = mapIn(files[h], hemispheres[h].count, response);
    std::copy(map.values.begin(), map.values.end(), values.begin() + hemispheres[h].first);
  }
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (!mask[v]) values[v] = kNaN;
  }
}

std::string sideOf(const std::string& column, const std::string& structure) {
  if (column == "left") return "CortexLeft";
  if (column == "right") return "CortexRight";
  return structure;
}

/// "Cortex" alone says of neither hemisphere that it is the other one.
bool statesSide(const std::string& structure) {
  return structure == "CortexLeft" || structure == "CortexRight";
}

/// Vertices of each hemisphere: of its surface, or of the first person's map.
void layOut(Context& context, const GlmSettings& s, const Table& list, const MapFiles& files,
            Observations& o) {
  const auto columns = fileColumns(list);
  if (!s.surfaces.empty() && s.surfaces.size() != columns.size()) {
    throw UsageError("--surface is to be given " + std::to_string(columns.size()) +
                     " times, once for each column of maps of '" + list.name + "'");
  }
  TriangleMesh whole;
  for (std::size_t h = 0; h < columns.size(); ++h) {
    MapSide side;
    side.first = o.places;
    if (s.surfaces.empty()) {
      side.count = io::readVertexMaps(files.front()[h]).front().values.size();
    } else {
      const auto loaded = io::readSurface(s.surfaces[h]);
      side.count = loaded.mesh.vertexCount();
      side.structure = loaded.metadata.structure;
      static_cast<void>(io::readVertexMaps(files.front()[h], side.count));  // one stands for all
      const std::string wanted = sideOf(columns[h], side.structure);
      if (statesSide(side.structure) && side.structure != wanted) {
        throw InvalidInput("'" + s.surfaces[h] + "' is of the other hemisphere than the column '" +
                           columns[h] + "' of '" + list.name +
                           "'; give --surface in the order left, right");
      }
      whole = h == 0 ? loaded.mesh : geometry::joined(whole, loaded.mesh);
    }
    side.structure = sideOf(columns[h], side.structure.empty() ? "Other" : side.structure);
    if (columns.size() > 1) side.prefix = columns[h] == "left" ? "hemi-L_" : "hemi-R_";
    o.places += side.count;
    o.hemispheres.push_back(std::move(side));
  }
  if (!s.surfaces.empty()) o.surface = statistics::placeSurface(whole);
  for (const auto& person : files) {
    for (std::size_t h = 0; h < person.size(); ++h) {
      const std::string said = io::statedStructure(context.input(person[h], "person"));
      const std::string& wanted = o.hemispheres[h].structure;
      if (!statesSide(said) || !statesSide(wanted) || said == wanted) continue;
      throw InvalidInput("'" + person[h].string() +
                         "' is of the other hemisphere than its column '" + columns[h] +
                         "' or the surface");
    }
  }
}

void requireOneEach(const std::vector<std::string>& files, const char* option,
                    const Observations& o) {
  if (!files.empty() && files.size() != o.hemispheres.size()) {
    throw UsageError(std::string("--") + option + " is to be given once for each surface");
  }
}

void readMask(const GlmSettings& s, Observations& o) {
  requireOneEach(s.masks, "mask", o);
  o.mask.assign(static_cast<std::size_t>(o.places), true);
  for (std::size_t h = 0; h < s.masks.size(); ++h) {
    const MapSide& side = o.hemispheres[h];
    const Eigen::VectorXd inside = io::readVertexNumbers(s.masks[h], side.count);
    for (Eigen::Index v = 0; v < side.count; ++v) o.mask[side.first + v] = inside[v] != 0;
  }
}

void readAtlases(const GlmSettings& s, Observations& o) {
  requireOneEach(s.atlases, "atlas", o);
  for (std::size_t h = 0; h < s.atlases.size(); ++h) {
    const auto labels = io::readVertexLabels(s.atlases[h], o.hemispheres[h].count);
    std::map<Label, std::string> names;
    for (const auto& entry : labels.table) names[entry.key] = entry.name;
    for (const Label key : labels.keys) o.hemispheres[h].regions.push_back(names[key]);
  }
}

/// Columns of regions: those that --columns names, else the model's response, else all numbers that
/// the model does not use.
std::vector<std::size_t> regionColumns(const Table& table, const GlmSettings& s) {
  const auto formula = statistics::parseFormula(s.model);
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string& name = table.columns[c];
    const auto is = [&](const std::string& pattern) {
      return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
    };
    const auto unused = [&] {
      return c != personColumn(table, s) && statistics::isNumeric(table, c) &&
             std::ranges::none_of(formula.terms, [&](const auto& term) {
               return std::ranges::find(term, name) != term.end();
             });
    };
    if (!s.columns.empty()             ? std::ranges::any_of(s.columns, is)
        : table.find(formula.response) ? name == formula.response
                                       : unused()) {
      columns.push_back(c);
    }
  }
  if (columns.empty()) {
    throw InvalidInput("'" + table.name +
                       "': no column holds what is to be analysed; name some with --columns");
  }
  const fs::path folder = fs::path(table.name).parent_path();
  for (const std::size_t c : columns) {
    if (!statistics::isNumeric(table, c) && isThere(folder / table.rows.front()[c])) {
      throw InvalidInput("'" + table.name + "': the column '" + table.columns[c] +
                         "' names files; a list of maps has a column file, or columns left and "
                         "right");
    }
  }
  return columns;
}

/// The people of a list with their rows of participants.tsv; which rows of the list they are.
std::vector<std::size_t> findPeople(const Table& list, const GlmSettings& s, Observations& o) {
  std::vector<std::string> all;
  for (const auto& row : list.rows) all.push_back(row[personColumn(list, s)]);
  const Table about = s.table ? statistics::readTable(*s.table) : list;
  auto joined = statistics::joinPeople(all, list.name, about, about.columns[personColumn(about, s)],
                                       s.subset);
  for (const std::size_t row : joined.used) o.people.push_back(all[row]);
  if (o.people.empty())
    throw InvalidInput("'" + list.name + "': holds nobody of '" + about.name + "'");
  o.about = std::move(joined.table);
  o.leftOut = std::move(joined.leftOut);
  return joined.used;
}

void observeRegions(const GlmSettings& s, const Table& table, Observations& o) {
  const auto rows = findPeople(table, s, o);
  const auto columns = regionColumns(table, s);
  for (const std::size_t c : columns) o.placeNames.push_back(table.columns[c]);
  o.places = static_cast<Eigen::Index>(columns.size());
  o.mask.assign(columns.size(), true);
  o.reader = [values = statistics::numbersIn(table, rows, columns)](std::size_t person,
                                                                    std::span<double> out) {
    Eigen::Map<Eigen::RowVectorXd>(out.data(), values.cols()) = values.row(person);
  };
}

/// "space-X_den-Y" of a file's name; empty where it does not say.
std::string spaceIn(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t at = name.find("_space-");
  if (at == std::string::npos) return {};
  std::size_t end = name.find_first_of("_.", at + 1);
  if (name.compare(end, 5, "_den-") == 0) end = name.find_first_of("_.", end + 1);
  return name.substr(at + 1, end - at - 1);
}

/// Vertices of two templates mean different places, even if they are as many.
void requireOneSpace(const MapFiles& files, const std::vector<std::string>& people) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t h = 0; h < files[i].size(); ++h) {
      const std::string here = spaceIn(files[i][h]), first = spaceIn(files[0][h]);
      if (here.empty() || first.empty() || here == first) continue;
      throw InvalidInput("'" + files[i][h].string() + "' of " + people[i] + " is on " + here +
                         ", that of " + people[0] + " on " + first);
    }
  }
}

void observeMaps(Context& context, const GlmSettings& s, const Table& list, Observations& o) {
  const auto files = filesOf(list, findPeople(list, s, o));
  requireOneSpace(files, o.people);
  layOut(context, s, list, files, o);
  readMask(s, o);
  readAtlases(s, o);
  o.reader = [files, hemispheres = o.hemispheres, mask = o.mask,
              response = statistics::parseFormula(s.model).response](std::size_t person,
                                                                     std::span<double> values) {
    readMaps(files[person], hemispheres, response, mask, values);
  };
}

}  // namespace

Observations readObservations(Context& context, const GlmSettings& s) {
  if (s.regions.has_value() == s.maps.has_value()) {
    throw UsageError("give a list of maps or a table of regions: LIST, or --maps");
  }
  const Table list = statistics::readTable(s.maps ? *s.maps : *s.regions);
  if (list.rows.empty()) throw InvalidInput("'" + list.name + "': holds nobody");
  Observations o;
  if (s.maps || list.find("file") || list.find("left") || list.find("right")) {
    observeMaps(context, s, list, o);
  } else {
    observeRegions(s, list, o);
  }
  return o;
}

void keepPeople(Observations& o, const std::vector<std::size_t>& rows) {
  if (rows.size() == o.people.size()) return;
  for (std::size_t n = 0; n < rows.size(); ++n) {  // ascending
    o.people[n] = o.people[rows[n]];
    o.about.rows[n] = o.about.rows[rows[n]];
  }
  o.people.resize(rows.size());
  o.about.rows.resize(rows.size());
  o.reader = [reader = o.reader, rows](std::size_t person, std::span<double> values) {
    reader(rows[person], values);
  };
}

}  // namespace explica::app
