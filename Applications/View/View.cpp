// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "View.h"
#include "Film.h"
#include "OpenedFiles.h"
#include "OpenedFolders.h"
#include "Steer.h"
#include "WindowProgram.h"

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VertexFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Report/Figure.h"
#include "Explica/Report/Picture.h"

#include <algorithm>
#include <filesystem>

namespace explica::app {
namespace {

struct ViewSettings {
  std::vector<std::string> files;
  std::optional<std::string> screenshot;
  std::optional<std::string> film;
  std::optional<std::string> map;
  std::optional<std::string> mapName;
  std::optional<std::string> labels;
  std::optional<std::string> region;
  std::vector<report::ViewName> views;
  std::optional<Eigen::Vector3d> direction;
  bool focus = false;
  std::optional<report::ColourMap> colours;
  std::optional<Eigen::Vector2d> range;
  int columns = 2;
  int slices = 3;
  double framesPerSecond = 10;
  io::SurfaceReadOptions reading;
  report::SurfacePictureOptions picture;
  SteerOptions window;
};

/// Options that pictures and films do not look at.
const std::vector<std::string> kOfWindow = {
    "vertex", "radius", "distance", "surround", "target-visibility", "save", "script"};

void declare(Declaration& d, ViewSettings& s) {
  d.synopsis("choose and steer an unfolding in a window; pictures and films without one")
      .description(
          R"(Without --screenshot or --film a window opens on a surface, or on a folder of `explica unfold`, `flatten` or `sample`: pick a centre (C), take the view as viewpoint (V), set the radius, run and pause (Space), step back and forth, save (W); F1 shows every key. Maps, labels and folders named after the surface are shown with it: of a folder of `explica sample` the maps, of `explica flatten` the patch and its flat map (`explica report` shows curves over the depth, and volumes on the flat map depth by depth). Where a map was not measured (off the valid.shape.gii beside it, thickness 0) it is grey. Surfaces are drawn with a map or labels on their vertices, from one or more sides; a volume is shown in slices with the cut lines of the surfaces named after it (the first red, the second yellow); a folder of `explica unfold` is shown as its evolution with --film. Pictures and films are drawn on the processor, without a display.)")
      .example(
          "explica view pial.surf.gii --map thickness.shape.gii --views left,right --screenshot "
          "pial.png",
          "Thickness on the pial surface, from both sides")
      .example("explica view T1.nii.gz white.surf.gii pial.surf.gii --screenshot slices.png",
               "White and pial surface on the T1")
      .example("explica view flat sampled", "A flat map and sampled maps in the window")
      .input("FILE", FileKind::Any,
             "surfaces; or a volume and surfaces; or a folder of `explica unfold`, `flatten` or "
             "`sample`",
             s.files)
      .oneByOne("FILE")
      .category("Picture")
      .option("screenshot", "PNG file to write", s.screenshot)
      .option("film",
              "film to write of a folder of `explica unfold`: .gif, or .mp4 or .webm where "
              "ffmpeg is installed; 800 x 600 pixels if --width and --height do not say",
              s.film)
      .inputOption("map", FileKind::VertexData, "per-vertex values to colour the surface by", s.map)
      .option("map-name", "which of the map file's maps (default: the first)", s.mapName)
      .inputOption("labels", FileKind::VertexLabel, "per-vertex labels to colour the surface by",
                   s.labels)
      .inputOption("region", FileKind::VertexLabel, "labels: vertices of label 0 are drawn paler",
                   s.region)
      .option("views", "sides to look from (default: left,right)", s.views)
      .option("direction", "look from this side instead: a direction from the surface to the eye",
              s.direction)
      .option("focus", "fill the picture with the --region, a film with the unfolded patch",
              s.focus)
      .option("colours", "colour map (default: by the values)", s.colours)
      .option("range", "values of the first and last colour", s.range)
      .option({"columns", "", "views in a row", 0, 100}, s.columns)
      .option({"slices", "", "slices of a volume in each direction", 0, 1000}, s.slices)
      .option("fps", "frames a second of a film", s.framesPerSecond)
      .options("Picture", s.picture)
      .options("Window", s.window)
      .options("Reading", s.reading)
      .excludes("screenshot", kOfWindow)
      .excludes("film", kOfWindow)
      .needs({"region", "views", "columns", "colours", "range", "width", "height", "samples",
              "occlusion"},
             {"screenshot", "film"})
      .needs({"slices"}, {"screenshot"})
      .needs({"map-name"}, {"map"})
      .needs({"focus"}, {"region", "film"})
      .needs({"fps"}, {"film"})
      .withoutOutput();
}

void paintLabels(const ShownSurface& surface, const std::string& file,
                 report::SurfacePaint& paint) {
  const io::LabelMap labels = readLabelsOn(surface, file);
  paint.labels = labels.keys;
  for (const io::LabelEntry& entry : labels.table) {
    paint.labelColours[entry.key] = report::colourOfLabel(entry.key, entry.colour);
  }
}

report::SurfacePaint readPaint(const ViewSettings& s, const ShownSurface& surface) {
  if (s.map && s.labels) {
    throw UsageError("a picture shows --map or --labels: leave one of them out");
  }
  report::SurfacePaint paint;
  if (s.map && io::namesLabels(*s.map)) {
    paintLabels(surface, *s.map, paint);
  } else if (s.map) {
    const auto maps = readMapsOn(surface, *s.map);
    const auto chosen =
        s.mapName ? std::find_if(maps.begin(), maps.end(),
                                 [&](const io::VertexMap& m) { return m.name == *s.mapName; })
                  : maps.begin();
    if (chosen == maps.end()) {
      throw InvalidInput(*s.map + ": holds no map named '" + s.mapName.value_or("") + "' but " +
                         joined(maps, ", ", [](const auto& m) { return m.name; }));
    }
    paint.values = chosen->values;
    paint.scale =
        report::scaleFor(paint.values, std::filesystem::path(chosen->name).filename().string(),
                         chosen->unit, s.colours);
    if (s.range) {
      paint.scale.low = s.range->x();
      paint.scale.high = s.range->y();
    }
  } else if (s.labels) {
    paintLabels(surface, *s.labels, paint);
  }
  if (s.region) paint.region = readLabelsOn(surface, *s.region).keys;
  return paint;
}

std::vector<report::FigureView> viewsOf(const ViewSettings& s, const report::SurfacePaint& paint) {
  std::vector<report::FigureView> views;
  if (s.direction) {
    report::FigureView view;
    view.towards = -*s.direction;
    views.push_back(view);
  }
  std::vector<report::ViewName> names = s.views;
  if (names.empty() && !s.direction) names = {report::ViewName::Left, report::ViewName::Right};
  for (const report::ViewName name : names) {
    report::FigureView view;
    view.name = name;
    views.push_back(view);
  }
  if (s.focus) {
    for (report::FigureView& view : views) {
      for (Eigen::Index v = 0; v < paint.region.size(); ++v) {
        if (paint.region[v] != 0) view.focus.push_back(static_cast<std::int32_t>(v));
      }
    }
  }
  return views;
}

report::Picture drawSlices(const ViewSettings& s) {
  const Volume<float> image = io::readScalars(s.files.front()).volume;
  std::vector<TriangleMesh> meshes;
  for (std::size_t f = 1; f < s.files.size(); ++f)
    meshes.push_back(io::readSurface(s.files[f], s.reading).mesh);
  const std::array<report::Colour, 4> colours = {
      {{1, 0.05f, 0.03f}, {1, 0.75f, 0}, {0.05f, 0.6f, 1}, {0.1f, 0.9f, 0.3f}}};
  std::vector<report::Contour> contours;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    contours.push_back({&meshes[m], colours[m % colours.size()], 1.4});
  return report::sliceFigure(image, contours, s.slices, s.picture.height / 3);
}

report::Picture drawSurfaces(const ViewSettings& s) {
  std::vector<report::Picture> figures;
  for (const std::string& file : s.files) {
    if (isFolder(file)) {
      throw UsageError("'" + file +
                       "' is a folder: --screenshot draws surfaces, or a volume with surfaces; a "
                       "folder of explica unfold is shown by --film or in the window");
    }
    const ShownSurface surface{io::readSurface(file, s.reading).mesh, file};
    const report::SurfacePaint paint = readPaint(s, surface);
    figures.push_back(
        report::surfaceFigure(surface.mesh, paint, viewsOf(s, paint), s.columns, s.picture));
  }
  return report::tilePictures(figures, s.columns);
}

/// The first file is a surface or an unfolding; the others are opened on it.
void openWindow(Context& context, const ViewSettings& s, const ShowWindow& show) {
  if (isVolume(s.files.front())) {
    throw UsageError(
        "the window shows a surface: name one first; or write a picture of slices with "
        "--screenshot FILE.png");
  }
  const bool folder = isFolder(s.files.front());
  const auto found = folder ? surfaceOfFolder(s.files.front()) : std::nullopt;
  if (folder && !found) {
    throw UsageError("'" + s.files.front() +
                     "': is no folder of explica unfold, flatten or sample");
  }
  if (found) context.input(found->file, "surface");
  for (std::size_t n = 1; n < s.files.size(); ++n) {
    // Opened on the first one: all are of one hemisphere.
    if (!isFolder(s.files[n])) context.input(s.files[n], "opened");
  }
  if (!show) startWindowProgram();
  const ShownSurface start =
      found ? *found
            : ShownSurface{io::readSurface(s.files.front(), s.reading).mesh, s.files.front()};
  std::vector<viewer::Opened> opened;
  for (std::size_t n = folder ? 0 : 1; n < s.files.size(); ++n) {
    opened.push_back(openForWindow(s.files[n], start));
  }
  for (const auto& file : {s.map, s.labels}) {
    if (file) opened.push_back(openForWindow(*file, start));
  }
  viewer::Opened first;
  first.maps.push_back({{"curvature", "mm^-1", maps::meanCurvature(start.mesh)}});
  first.what =
      "1: press C over the middle of a fold. 2: turn the surface, V takes the view as viewpoint. "
      "3: Space unfolds. F1 shows every key.";
  opened.push_back(std::move(first));
  const Vector direction = s.direction.value_or(start.direction.value_or(Vector(-1, 0, 0)));
  steer(context, start, s.reading, direction, std::move(opened), s.window, show);
}

Termination run(Context& context, const ViewSettings& s, const ShowWindow& show) {
  if (!s.screenshot && !s.film) {
    const StopScope window(nullptr);  // its user ends it; no exception may pass its library
    openWindow(context, s, show);
    return Termination::NotRun;
  }
  if (s.screenshot && std::filesystem::path(*s.screenshot).extension() != ".png") {
    throw UsageError("--screenshot " + *s.screenshot + ": expected a name ending in .png");
  }
  if (s.film) {
    requireFilmFormat(*s.film);
    const std::filesystem::path folder = s.files.front();
    report::SurfacePictureOptions picture = s.picture;
    if (!context.given("width")) picture.width = 800;
    if (!context.given("height")) picture.height = 600;
    std::optional<report::SurfacePaint> paint;
    if (s.map || s.labels) paint = readPaint(s, {firstFrame(folder), folder.string()});
    std::vector<report::FigureView> views;
    if (s.direction || !s.views.empty()) views = viewsOf(s, {});
    writeFilm(*s.film, drawFilm(folder, paint, std::move(views), s.columns, s.focus, picture),
              s.framesPerSecond);
    context.info("wrote " + *s.film);
  }
  if (s.screenshot) {
    report::writePng(*s.screenshot, isVolume(s.files.front()) ? drawSlices(s) : drawSurfaces(s));
    context.info("wrote " + *s.screenshot);
  }
  return Termination::NotRun;
}

}  // namespace

Command viewCommandShowing(ShowWindow show) {
  return Command("view", [show] {
    auto settings = std::make_shared<ViewSettings>();
    Invocation invocation;
    declare(invocation.declaration, *settings);
    invocation.run = [settings, show](Context& context) { return run(context, *settings, show); };
    invocation.settings = settings;
    return invocation;
  });
}

Command viewCommand() {
  return viewCommandShowing({});
}

}  // namespace explica::app
