// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "StatsFile.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Maps/Regions.h"

#include <algorithm>
#include <optional>
#include <span>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct RegionsSettings {
  std::string folder;
  std::vector<std::string> atlases, maps;
  std::optional<std::string> hemisphere, person;
};

void declare(Declaration& d, RegionsSettings& s) {
  d.synopsis("area, volume, thickness, curvature and any map by region of an atlas")
      .description(
          "Takes the surfaces and maps of one hemisphere from a folder, FreeSurfer's surf or one "
          "of explica surface, and any annotation of the same vertices. What is missing there is "
          "not in the tables: areas are those of the white surface, or of the map area; grey "
          "volume is the one between white and pial surface (three tetrahedra over each face), or "
          "the map volume; curvature is the map curv, or the white surface's.\n\n"
          "ATLAS.stats has FreeSurfer's form and definitions: thickness is the mean over vertices, "
          "its deviation has n in the denominator. MeanCurv is the mean absolute value of the "
          "curvature map over the area; FreeSurfer takes it of a curvature that it does not write, "
          "so that the numbers differ; its last three columns are left out. regions.tsv has one "
          "row for each region and measure; NAME_mean is weighted by area, NAME_mean_vertices not. "
          "thickness_mean is weighted by the area of the middle surface, as everywhere, where "
          "white and pial surface are there, and leaves out where thickness is 0, which is not "
          "known.")
      .example("explica regions bert/surf --atlas bert/label/lh.aparc.annot --out tables",
               "The table of FreeSurfer's own surfaces, as tables/lh.aparc.stats and regions.tsv")
      .input("SURFACES", FileKind::Folder, "folder with surfaces and maps of a person", s.folder)
      .inputOption("atlas", FileKind::VertexLabel, "annotation or labels of the surface's vertices",
                   s.atlases)
      .require("atlas")
      .inputOption("map", FileKind::VertexData, "a further map to be measured", s.maps)
      .category("Input")
      .option("hemisphere", "L or R, where the atlas' name does not say", s.hemisphere)
      .category("Output")
      .option("person", "name in the tables; unset: the folder's", s.person)
      .output("*.stats", FileKind::Table, "?h.ATLAS.stats: FreeSurfer's table of an atlas")
      .output("regions.tsv", FileKind::Table,
              "person, hemisphere, atlas, region, measure, value, unit");
}

/// What is known of one hemisphere.
struct MeasuredSide {
  std::string structure;
  Eigen::VectorXd areas, volumes, thickness, curvature;  ///< V; empty: not known
  Eigen::VectorXd middleAreas;                           ///< V; of the middle surface, else `areas`
  std::vector<io::VertexMap> maps;
};

std::string sideOf(const RegionsSettings& s) {
  if (s.hemisphere) {
    if (*s.hemisphere != "L" && *s.hemisphere != "R") {
      throw UsageError("--hemisphere must be L or R");
    }
    return *s.hemisphere;
  }
  const std::string structure = io::statedStructure(s.atlases.front());
  if (structure.empty()) {
    throw UsageError("'" + s.atlases.front() +
                     "' does not say of which hemisphere it is; say it with --hemisphere L or R");
  }
  return structure == "CortexRight" ? "R" : "L";
}

/// A file of the folder, or of a FreeSurfer subject's surf/ in it, by FreeSurfer's name or our own.
std::optional<fs::path> fileOf(Context& context, const RegionsSettings& s, const std::string& side,
                               const std::string& fsName, const std::string& ours) {
  for (const std::string& name : {(side == "L" ? "lh." : "rh.") + fsName, ours}) {
    for (const fs::path& folder : {fs::path(s.folder), fs::path(s.folder) / "surf"}) {
      if (isThere(folder / name)) return context.input(folder / name, fsName);
    }
  }
  return {};
}

Eigen::VectorXd mapOf(const std::optional<fs::path>& path, std::optional<Eigen::Index>& count) {
  if (!path) return {};
  const Eigen::VectorXd values = io::readVertexMaps(*path, count).front().values;
  count = values.size();
  return values;
}

MeasuredSide readHemisphere(Context& context, const RegionsSettings& s, const std::string& side) {
  MeasuredSide found;
  found.structure = side == "L" ? "CortexLeft" : "CortexRight";
  const auto file = [&](const std::string& fsName, const std::string& ours) {
    return fileOf(context, s, side, fsName, ours);
  };
  io::SurfaceReadOptions reading{.space = io::SurfaceSpace::Scanner};
  std::optional<Eigen::Index> count;
  const auto white = file("white", "white.surf.gii"), pial = file("pial", "pial.surf.gii");
  if (white) {
    TriangleMesh mesh = io::readSurface(*white, reading).mesh;
    count = mesh.vertexCount();
    found.areas = geometry::vertexAreas(mesh);
    if (pial) {
      const TriangleMesh outer = io::readSurface(*pial, reading).mesh;
      found.volumes = maps::vertexVolumes(mesh, outer);
      if (found.volumes.sum() < 0) {  // faces that run clockwise seen from outside
        found.volumes = -found.volumes;
        mesh.faces.col(1).swap(mesh.faces.col(2));
      }
      const auto mid = file("graymid", "mid.surf.gii");
      found.middleAreas = geometry::vertexAreas(
          mid ? io::readSurface(*mid, reading).mesh
              : TriangleMesh{0.5 * (mesh.positions + outer.positions), mesh.faces});
    }
    found.curvature = mapOf(file("curv", "curvature.shape.gii"), count);
    if (found.curvature.size() == 0) found.curvature = maps::meanCurvature(mesh);
  } else {
    found.areas = mapOf(file("area", "area.shape.gii"), count);
    found.curvature = mapOf(file("curv", "curvature.shape.gii"), count);
  }
  if (found.areas.size() == 0) {
    throw InvalidInput("'" + s.folder +
                       "': holds no white surface and no map of vertex areas of hemisphere " +
                       side + " (looked for ?h.white, white.surf.gii, ?h.area, area.shape.gii)");
  }
  if (found.middleAreas.size() == 0) found.middleAreas = found.areas;
  if (found.volumes.size() == 0) found.volumes = mapOf(file("volume", "volume.shape.gii"), count);
  found.thickness = mapOf(file("thickness", "thickness.shape.gii"), count);
  for (const std::string& path : s.maps) {
    for (io::VertexMap& map : io::readVertexMaps(path, count)) found.maps.push_back(std::move(map));
  }
  return found;
}

/// One measure of all regions, and of all of them together at the end.
struct Measure {
  std::string name, unit;
  std::vector<double> values;
};

/// Regions of one atlas with their measures.
struct AtlasTable {
  std::string name;
  std::vector<std::string> regions;
  std::vector<StatsRow> rows;  ///< one more than regions: all together
  std::vector<Measure> measures;
};

/// Moments in each region, and in all together.
std::vector<maps::RegionMoments> momentsOf(const io::LabelMap& labels, const Eigen::VectorXd& map,
                                           const Eigen::VectorXd& areas) {
  std::vector<Label> regions;
  for (const io::LabelEntry& entry : labels.table) regions.push_back(entry.key);
  const std::span<const Label> keys(labels.keys.data(),
                                    static_cast<std::size_t>(labels.keys.size()));
  auto moments = maps::regionMoments(keys, map, areas, regions);
  std::vector<Label> one(keys.size());
  std::transform(keys.begin(), keys.end(), one.begin(),
                 [](Label key) { return key == io::kNoRegion ? 0 : 1; });
  moments.push_back(maps::regionMoments(one, map, areas, std::vector<Label>{1}).front());
  return moments;
}

template <class Value>
void addMeasure(AtlasTable& table, const std::string& name, const std::string& unit,
                const std::vector<maps::RegionMoments>& moments, const Value& value) {
  Measure measure{name, unit, {}};
  for (const maps::RegionMoments& region : moments) measure.values.push_back(value(region));
  table.measures.push_back(std::move(measure));
}

/// @param overArea  of what the mean over area is taken
void addMoments(AtlasTable& table, const std::string& name, const std::string& unit,
                const std::vector<maps::RegionMoments>& overArea,
                const std::vector<maps::RegionMoments>& moments) {
  addMeasure(table, name + "_mean", unit, overArea, [](const auto& r) { return r.meanOverArea; });
  addMeasure(table, name + "_mean_vertices", unit, moments, [](const auto& r) { return r.mean; });
  addMeasure(table, name + "_sd_vertices", unit, moments,
             [](const auto& r) { return r.deviation; });
}

AtlasTable measured(const MeasuredSide& side, const io::LabelMap& labels) {
  AtlasTable table{labels.name, {}, {}, {}};
  for (const io::LabelEntry& entry : labels.table) table.regions.push_back(entry.name);
  const auto areas = momentsOf(labels, side.areas, side.areas);
  for (std::size_t r = 0; r < areas.size(); ++r) {
    table.rows.emplace_back();
    if (r < table.regions.size()) table.rows[r].name = table.regions[r];
    table.rows[r].vertices = areas[r].count;
    table.rows[r].area = areas[r].sum;
  }
  addMeasure(table, "vertices", "1", areas, [](const auto& r) { return double(r.count); });
  addMeasure(table, "area", "mm^2", areas, [](const auto& r) { return r.sum; });
  if (side.volumes.size() > 0) {
    const auto volumes = momentsOf(labels, side.volumes, side.areas);
    for (std::size_t r = 0; r < volumes.size(); ++r) table.rows[r].volume = volumes[r].sum;
    addMeasure(table, "volume", "mm^3", volumes, [](const auto& r) { return r.sum; });
  }
  if (side.thickness.size() > 0) {
    const auto thickness = momentsOf(labels, side.thickness, side.areas);
    for (std::size_t r = 0; r < thickness.size(); ++r) {
      table.rows[r].thicknessMean = thickness[r].mean;
      table.rows[r].thicknessDeviation = thickness[r].deviation;
    }
    const Eigen::VectorXd known = (side.thickness.array() > 0).select(side.thickness, kNaN);
    addMoments(table, "thickness", "mm", momentsOf(labels, known, side.middleAreas), thickness);
  }
  if (side.curvature.size() > 0) {
    const auto bending = momentsOf(labels, side.curvature.cwiseAbs(), side.areas);
    for (std::size_t r = 0; r < bending.size(); ++r)
      table.rows[r].meanCurvature = bending[r].meanOverArea;
    const auto curvature = momentsOf(labels, side.curvature, side.areas);
    addMoments(table, "curvature", "mm^-1", curvature, curvature);
  }
  for (const io::VertexMap& map : side.maps) {
    const auto moments = momentsOf(labels, map.values, side.areas);
    addMoments(table, map.name, map.unit, moments, moments);
  }
  return table;
}

std::string longRows(const std::string& person, const std::string& side, const AtlasTable& table) {
  std::string text;
  for (std::size_t r = 0; r < table.regions.size(); ++r) {
    for (const Measure& measure : table.measures) {
      text += person + "\t" + side + "\t" + table.name + "\t" + table.regions[r] + "\t" +
              measure.name + "\t" + cellText(measure.values[r], "%.7g") + "\t" +
              (measure.unit.empty() ? "n/a" : measure.unit) + "\n";
    }
  }
  return text;
}

/// What is given, else the name of the subject's folder of FreeSurfer's surf, else of the folder.
std::string personIn(const RegionsSettings& s) {
  if (s.person) return *s.person;
  fs::path folder = fs::absolute(s.folder).lexically_normal();
  if (folder.filename().empty()) folder = folder.parent_path();
  if (folder.filename() == "surf") folder = folder.parent_path();
  return folder.filename().string();
}

/// "lh.aparc" of "lh.aparc.annot", with the hemisphere in front where the name has none.
std::string stemOfAtlas(const std::string& path, const std::string& side) {
  std::string stem = fs::path(path).filename().string();
  for (const std::string ending : {".gz", ".gii", ".label", ".annot"}) {
    if (stem.ends_with(ending)) stem.resize(stem.size() - ending.size());
  }
  if (stem.starts_with("lh.") || stem.starts_with("rh.")) return stem;
  return (side == "L" ? "lh." : "rh.") + stem;
}

Termination run(Context& context, const RegionsSettings& s) {
  const std::string side = sideOf(s);
  const MeasuredSide hemisphere = readHemisphere(context, s, side);
  std::vector<fs::path> atlases(s.atlases.begin(), s.atlases.end());
  const auto labels = io::readRegions(atlases, hemisphere.areas.size());
  auto step = context.step("regions");
  std::string text = "person\themisphere\tatlas\tregion\tmeasure\tvalue\tunit\n";
  std::size_t regions = 0;
  for (std::size_t a = 0; a < labels.size(); ++a) {
    AtlasTable table = measured(hemisphere, labels[a]);
    const std::string stem = stemOfAtlas(s.atlases[a], side);
    table.name = stem.substr(3);
    text += longRows(personIn(s), side, table);
    regions += table.regions.size();
    const StatsHead head{personIn(s), stem.substr(0, 2),
                         fs::path(s.atlases[a]).filename().string()};
    const StatsRow cortex = table.rows.back();
    table.rows.pop_back();
    writeTextFile(context.output(stem + ".stats"), statsText(head, cortex, table.rows));
  }
  writeTextFile(context.output("regions.tsv"), text);
  context.result("regions", regions);
  return Termination::NotRun;
}

}  // namespace

Command regionsCommand() {
  return makeCommand<RegionsSettings>("regions", declare, run);
}

}  // namespace explica::app
