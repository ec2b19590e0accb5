// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VertexFile.h"
#include "Explica/Pipeline/FlatMarks.h"
#include "Explica/Report/Panels.h"
#include "ShownSurface.h"

#include <algorithm>
#include <filesystem>
#include <functional>

namespace explica::app {

enum class FigureSide { Lateral, Medial, Dorsal, Ventral, Frontal, Occipital };
constexpr auto enumWords(FigureSide) {
  using enum FigureSide;
  return std::to_array<EnumWord<FigureSide>>({{Lateral, "lateral"},
                                              {Medial, "medial"},
                                              {Dorsal, "dorsal"},
                                              {Ventral, "ventral"},
                                              {Frontal, "frontal"},
                                              {Occipital, "occipital"}});
}
enum class FigureLayout { Grid, Row, Column };
constexpr auto enumWords(FigureLayout) {
  using enum FigureLayout;
  return std::to_array<EnumWord<FigureLayout>>({{Grid, "grid"}, {Row, "row"}, {Column, "column"}});
}

namespace {

struct FigureSettings {
  std::vector<std::string> files;
  std::vector<FigureSide> views = {FigureSide::Lateral, FigureSide::Medial};
  FigureLayout layout = FigureLayout::Grid;
  int size = 2000;
  std::optional<report::ColourMap> colours;
  std::optional<Eigen::Vector2d> range;
  io::SurfaceReadOptions reading;
};

void declare(Declaration& d, FigureSettings& s) {
  d.synopsis("a figure for print: surfaces of both hemispheres, flat maps, one colour bar")
      .description(
          R"(Each map or annotation colours the surfaces of its hemisphere with as many vertices, in any order; of several maps the first. A map named curv or sulc is drawn beneath as light gyri and dark sulci. On flat maps (one z) annotations are outlines with names, and with a folded surface of the same mesh in the figure the directions of the body are shown. All surfaces have one scale, all maps one colour bar. figure.svg has layers for the pictures of the surfaces, the outlines of regions (a path each), their names, the titles, the scale and the colour bar, whose lines and text can be edited.)")
      .example(
          "explica figure lh.inflated rh.inflated lh.thickness rh.thickness lh.sulc rh.sulc --out "
          "figure",
          "Thickness on both hemispheres, lateral and medial")
      .example("explica figure flat/patch_flat.surf.gii flat/patch_aparc.label.gii --out figure",
               "Regions outlined on a flat map")
      .input("FILE", FileKind::Any,
             "surfaces, flat maps, per-vertex maps and annotations of one or both hemispheres",
             s.files)
      .oneByOne("FILE")
      .category("Picture")
      .option("views", "sides of each surface", s.views)
      .option("layout", "a column a surface and a row a view, all in one row, or a row a surface",
              s.layout)
      .option({"size", "pixels", "width of the figure", 100, 20000}, s.size)
      .option("colours", "colour map (default: by the values)", s.colours)
      .option("range", "values of the first and last colour", s.range)
      .options("Reading", s.reading)
      .output("figure.png", FileKind::Picture, "the figure")
      .output("figure.svg", FileKind::Picture, "the same in layers");
}

/// A surface of the figure, with what colours it.
struct Shown {
  ShownSurface surface;
  std::optional<Hemisphere> side;
  bool flat = false;
  std::optional<io::VertexMap> map;
  std::optional<io::LabelMap> labels;
  Eigen::VectorXd folding;
  report::SurfacePaint paint;
};

/// The vertices that faces have, as files of flat maps hold others, too.
Shown shownOf(const io::LoadedSurface& loaded, const std::string& file) {
  Shown shown;
  shown.side = io::statedHemisphere(file);
  const auto all = loaded.mesh.allFaces();
  shown.flat = flattening::isFlatMap(loaded.mesh, all);
  geometry::SubMesh part = geometry::extractFaces(loaded.mesh, all);
  shown.surface.mesh = std::move(part.mesh);
  shown.surface.file = file;
  if (shown.surface.mesh.vertexCount() < loaded.mesh.vertexCount()) {
    shown.surface.origin = std::move(part.vertexOrigin);
    shown.surface.wholeCount = loaded.mesh.vertexCount();
  }
  return shown;
}

bool isFolding(const std::string& file, const std::string& name) {
  const std::string text = std::filesystem::path(file).filename().string() + "\n" + name;
  return text.find("curv") != std::string::npos || text.find("sulc") != std::string::npos;
}

/// Whether vertex data are of a surface's hemisphere and have its vertices.
bool fits(const Shown& shown, const std::optional<Hemisphere>& side, Eigen::Index count) {
  const bool sameSide = !side || !shown.side || *side == *shown.side;
  return sameSide &&
         (count == shown.surface.mesh.vertexCount() || count == shown.surface.wholeCount);
}

/// Gives vertex data to the surfaces that they fit.
void give(const std::string& file, std::vector<Shown>& all) {
  const auto side = io::statedHemisphere(file);
  const bool labels = io::namesLabels(file);
  const Eigen::Index count = labels ? io::readVertexLabels(file).keys.size()
                                    : io::readVertexMaps(file).front().values.size();
  bool fitting = false, given = false;
  for (Shown& shown : all) {
    if (!fits(shown, side, count)) continue;
    fitting = true;
    if (labels) {
      given = given || !shown.labels;
      if (!shown.labels) shown.labels = readLabelsOn(shown.surface, file);
      continue;
    }
    const io::VertexMap map = readMapsOn(shown.surface, file).front();
    const bool folding = isFolding(file, map.name);
    given = given || folding || !shown.map;
    if (folding) {
      shown.folding = map.values;
    } else if (!shown.map) {
      shown.map = map;
    }
  }
  if (given) return;
  if (fitting) {
    throw InvalidInput("'" + file + "': the surfaces that it fits have another " +
                       (labels ? "annotation" : "map") +
                       " already; draw it in a figure of its own");
  }
  throw InvalidInput(
      "'" + file + "': " + std::to_string(count) + " vertices" +
      (side ? " of the " + std::string(nameOf(*side)) + " hemisphere" : "") +
      ", which no surface of the figure has; name a surface of the same mesh and side");
}

std::vector<Shown> readFiles(const FigureSettings& s) {
  std::vector<Shown> all;
  std::vector<std::string> data;
  for (const std::string& file : s.files) {
    std::optional<io::LoadedSurface> loaded;
    try {
      if (!io::namesLabels(file)) loaded = io::readSurface(file, s.reading);
    } catch (const Error&) {
      // No surface: vertex data, whose own fault is said then.
    }
    loaded ? all.push_back(shownOf(*loaded, file)) : data.push_back(file);
  }
  if (all.empty()) {
    throw InvalidInput("'" + s.files.front() +
                       "': is no surface; give the surface that it belongs to as well");
  }
  for (const std::string& file : data) give(file, all);
  std::stable_sort(all.begin(), all.end(), [](const Shown& a, const Shown& b) {
    return a.side != b.side && a.side == Hemisphere::Left;
  });
  return all;
}

/// The map's name without folder and hemisphere: FreeSurfer's "lh.thickness" is thickness.
std::string titleOf(const io::VertexMap& map) {
  return io::withoutSide(std::filesystem::path(map.name).filename().string());
}

/// One colour bar shows one quantity.
void warnOfOthers(Context& context, const std::vector<Shown>& all) {
  std::vector<std::string> titles;
  for (const Shown& shown : all) {
    if (shown.map) titles.push_back(titleOf(*shown.map));
  }
  const auto other = std::ranges::adjacent_find(titles, std::not_equal_to<>());
  if (other == titles.end()) return;
  context.warn("maps of different names, '" + other[0] + "' and '" + other[1] +
               "', share one colour bar, which has the name of the first");
}

/// One scale for all maps; none without maps.
std::optional<report::ColourScale> scaleOf(const FigureSettings& s, const std::vector<Shown>& all) {
  std::vector<double> pooled;
  const io::VertexMap* first = nullptr;
  for (const Shown& shown : all) {
    if (!shown.map) continue;
    if (!first) first = &*shown.map;
    pooled.insert(pooled.end(), shown.map->values.begin(), shown.map->values.end());
  }
  if (!first) return {};
  report::ColourScale scale =
      report::scaleFor(asVector(pooled), titleOf(*first), first->unit, s.colours);
  if (s.range) {
    scale.low = s.range->x();
    scale.high = s.range->y();
  }
  return scale;
}

void paint(Shown& shown, const std::optional<report::ColourScale>& scale) {
  shown.paint.folding = shown.folding;
  if (shown.map) {
    shown.paint.values = shown.map->values;
    shown.paint.scale = *scale;
  } else if (shown.labels && !shown.flat) {
    shown.paint.labels = shown.labels->keys;
    for (const io::LabelEntry& entry : shown.labels->table) {
      shown.paint.labelColours[entry.key] = report::colourOfLabel(entry.key, entry.colour);
    }
  }
}

report::ViewName viewOf(FigureSide side, bool right) {
  using enum report::ViewName;
  constexpr std::array ofLeft = {Left, Right, Top, Bottom, Front, Back};  // in FigureSide's order
  constexpr std::array ofRight = {Right, Left, Top, Bottom, Front, Back};
  return (right ? ofRight : ofLeft)[static_cast<std::size_t>(side)];
}

/// Places of a flat map's vertices on a folded surface of the figure; none without one of its mesh.
std::optional<Positions> foldedOf(const Shown& flat, const std::vector<Shown>& all) {
  const ShownSurface& map = flat.surface;
  const Eigen::Index whole = map.origin.empty() ? map.mesh.vertexCount() : map.wholeCount;
  for (const Shown& other : all) {
    if (other.flat || other.side != flat.side || other.surface.mesh.vertexCount() != whole)
      continue;
    const Positions& positions = other.surface.mesh.positions;
    return map.origin.empty() ? positions : Positions(positions(map.origin, Eigen::all));
  }
  return {};
}

report::Panel panelOf(const Shown& shown, const std::optional<FigureSide>& side,
                      const std::vector<Shown>& all) {
  const std::string name = shown.side ? std::string(nameOf(*shown.side)) : "";
  report::Panel panel{&shown.surface.mesh, shown.paint, report::ViewName::Top, {}, name};
  if (side) {
    panel.view = viewOf(*side, shown.side == Hemisphere::Right);
    panel.title += (name.empty() ? "" : ", ") + std::string(nameOf(*side));
  } else {
    panel.marks.emplace();
    if (const auto folded = foldedOf(shown, all)) {
      pipeline::markDirections(*folded, shown.surface.mesh, *panel.marks);
    }
    if (shown.labels) pipeline::markRegions(*shown.labels, shown.surface.mesh, *panel.marks);
  }
  return panel;
}

/// Surfaces by the layout, flat maps in a row below.
std::vector<std::vector<report::Panel>> rowsOf(const FigureSettings& s,
                                               const std::vector<Shown>& all) {
  std::vector<std::vector<report::Panel>> rows;
  std::vector<report::Panel> flat;
  const bool grid = s.layout == FigureLayout::Grid, column = s.layout == FigureLayout::Column;
  for (const Shown& shown : all) {
    if (shown.flat) {
      flat.push_back(panelOf(shown, {}, all));
      continue;
    }
    if (column || rows.empty()) rows.resize(column ? rows.size() + 1 : grid ? s.views.size() : 1);
    for (std::size_t v = 0; v < s.views.size(); ++v) {
      rows[grid ? v : rows.size() - 1].push_back(panelOf(shown, s.views[v], all));
    }
  }
  if (!flat.empty()) rows.push_back(std::move(flat));
  return rows;
}

Termination run(Context& context, const FigureSettings& s) {
  std::vector<Shown> all = readFiles(s);
  warnOfOthers(context, all);
  const auto scale = scaleOf(s, all);
  for (Shown& shown : all) paint(shown, scale);
  auto step = context.step("draw");
  const report::Canvas figure = report::panelFigure(rowsOf(s, all), scale, s.size);
  report::writePng(context.output("figure.png"), figure.picture());
  writeTextFile(context.output("figure.svg"), figure.svg());
  return Termination::NotRun;
}

}  // namespace

Command figureCommand() {
  return makeCommand<FigureSettings>("figure", declare, run);
}

}  // namespace explica::app
