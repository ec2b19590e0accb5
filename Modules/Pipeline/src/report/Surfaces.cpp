// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "CloseUps.h"
#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Report/Chart.h"
#include "Explica/Report/Evolution.h"
#include "Explica/Report/Figure.h"
#include "Explica/Report/SliceStack.h"
#include "MaskBorder.h"
#include "ReportParts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

/// One hemisphere's surfaces.
struct Hemisphere {
  const StepFolder* step = nullptr;
  std::string side;
  TriangleMesh white;
  TriangleMesh pial;
};

/// A scan that shows the anatomy of a label volume: beside it in the folder of a FreeSurfer subject
/// or of fMRIPrep.
std::optional<fs::path> scanBeside(const fs::path& labels) {
  for (const char* name : {"brain.mgz", "T1.mgz", "norm.mgz", "orig.mgz"}) {
    if (labels.parent_path().filename() == "mri" && isThere(labels.parent_path() / name)) {
      return labels.parent_path() / name;
    }
  }
  const std::string name = labels.filename().string();
  const std::size_t at = name.rfind("_dseg");
  if (at == std::string::npos) return {};
  const fs::path scan =
      labels.parent_path() / (name.substr(0, at) + "_desc-preproc_T1w" + name.substr(at + 5));
  return isThere(scan) ? std::optional(scan) : std::nullopt;
}

/// The image on which a surface is judged: the T1, or what lies beside the labels, or the labels.
std::optional<fs::path> imageOf(const ResultFolder& results, const StepFolder& step) {
  for (const char* role : {"image", "T1"}) {
    if (const auto image = inputOf(step, role); image && isThere(*image)) return image;
  }
  for (const StepFolder* segment : results.stepsOf("segment")) {
    if (const auto image = inputOf(*segment, "T1"); image && isThere(*image)) return image;
  }
  const auto labels = inputOf(step, "SEG");
  if (!labels || !isThere(*labels)) return {};
  return scanBeside(*labels).value_or(*labels);
}

/// Values where they are known: on the medial wall, where a surface has no grey matter, a map holds
/// 0 in place of "not known".
Eigen::VectorXd known(Eigen::VectorXd values, const Eigen::VectorXd& thickness) {
  for (Eigen::Index v = 0; v < values.size() && v < thickness.size(); ++v) {
    if (!(thickness[v] > 0)) values[v] = kNaN;
  }
  return values;
}

/// One scale for a map of every hemisphere.
report::ColourScale commonScale(const std::vector<Eigen::VectorXd>& values, const std::string& name,
                                const std::string& unit) {
  std::vector<double> pooled;
  for (const Eigen::VectorXd& one : values) pooled.insert(pooled.end(), one.begin(), one.end());
  return report::scaleFor(asVector(pooled), name, unit);
}

/// A map of `explica surface` for the view in three dimensions.
/// @return its values and scale, or nothing where a hemisphere lacks it
std::optional<std::pair<std::vector<Eigen::VectorXd>, report::ColourScale>> addMap(
    ResultFolder& results, const std::vector<Hemisphere>& all, const char* file,
    const std::string& word) {
  std::vector<Eigen::VectorXd> values;
  std::string unit;
  for (const Hemisphere& h : all) {
    const Eigen::Index n = h.pial.vertexCount();
    const auto map = mapNamed(h.step->folder / file, n);
    if (!map) return {};
    const auto thickness = mapNamed(h.step->folder / "thickness.shape.gii", n);
    values.push_back(thickness ? known(map->values, thickness->values) : map->values);
    unit = map->unit;
  }
  const report::ColourScale scale = commonScale(values, word, unit);
  for (std::size_t h = 0; h < all.size(); ++h) {
    results.content().evolutions[h].maps.push_back({values[h], scale});
  }
  return std::pair{std::move(values), scale};
}

/// Thickness, and where no sulcus hides it beside the verdict: the inflated hemispheres from their
/// outer sides.
void showThickness(ResultFolder& results, const std::vector<Hemisphere>& all) {
  const auto map = addMap(results, all, "thickness.shape.gii", "thickness");
  if (!map) return;
  const auto& [values, scale] = *map;
  const report::SurfacePictureOptions size{.width = 300, .height = 230};
  std::vector<TriangleMesh> meshes;
  std::vector<report::Camera> cameras;
  double half = 0;
  for (std::size_t h = 0; h < all.size(); ++h) {
    const auto& shapes = results.content().evolutions[h].shapes;
    const auto shape = std::ranges::find(shapes, "inflated", &report::EvolutionShape::name);
    meshes.push_back({shape->positions, all[h].white.faces});
    const auto from = all[h].side == "right" ? report::ViewName::Right : report::ViewName::Left;
    cameras.push_back(report::cameraFor(meshes.back().positions, from, size.width, size.height));
    half = std::max(half, cameras.back().halfHeight);
  }
  report::ReportGlance glance{
      kPatchPlace, "Thickness, inflated",
      "Right: 2 to 3 mm, crowns of gyri thicker than the floors of sulci, primary sensory and "
      "visual cortex thinnest. Wrong: stripes or spots thinner than 1 mm or thicker than 5 mm. "
      "Then: look at the slices there."};
  for (std::size_t h = 0; h < all.size(); ++h) {
    cameras[h].halfHeight = half;
    glance.views.emplace_back(
        (all[h].side.empty() ? "" : all[h].side + ", ") + "lateral",
        report::SurfaceScene(meshes[h]).render(cameras[h], report::coloursOf(values[h], scale),
                                               report::Filling::Smooth, size));
  }
  glance.scale = scale;
  results.content().glance.push_back(std::move(glance));
}

/// The surface that the patch is of: its shape's name.
std::string openedShape(const StepFolder* unfold) {
  const auto file = unfold ? inputOf(*unfold, "SURFACE") : std::nullopt;
  const std::string name = file ? file->filename().string() : "";
  for (const char* shape : {"white", "pial"}) {
    if (name.find(shape) != std::string::npos) return shape;
  }
  return "middle";
}

/// A hemisphere in all its shapes for the view in three dimensions.
report::Evolution brainOf(ResultFolder& results, const Hemisphere& h) {
  report::Evolution evolution;
  evolution.title = h.side;
  evolution.scene = "Cortex";
  std::vector<report::EvolutionShape> shapes = {{"white", h.white.positions}};
  if (h.step->has("mid.surf.gii")) {
    const TriangleMesh middle = io::readSurface(h.step->folder / "mid.surf.gii").mesh;
    if (middle.vertexCount() == h.white.vertexCount()) {
      shapes.push_back({"middle", middle.positions});
    }
  }
  shapes.push_back({"pial", h.pial.positions});
  const std::string opened = openedShape(results.beside(*h.step, "unfold"));
  auto own = std::ranges::find_if(
      shapes, [&](const report::EvolutionShape& shape) { return shape.name == opened; });
  if (own == shapes.end()) own = shapes.begin();
  evolution.mesh = {std::exchange(own->positions, {}), h.white.faces};
  shapes.push_back({"inflated", maps::inflated(h.white).positions});
  for (const auto& [command, file] :
       {std::pair{"register", "sphere.reg.surf.gii"}, std::pair{"sphere", "sphere.surf.gii"}}) {
    const StepFolder* step = results.beside(*h.step, command);
    if (step == nullptr || !step->has(file)) continue;
    const TriangleMesh sphere = io::readSurface(step->folder / file).mesh;
    if (sphere.vertexCount() != h.white.vertexCount()) continue;
    shapes.push_back({"sphere", sphere.positions});
    break;
  }
  evolution.shapes = std::move(shapes);
  results.attempt("Regions", [&] {
    addLabels(evolution, "regions", h.step->folder / "regions.label.gii");
    if (const StepFolder* parcellated = results.beside(*h.step, "parcellate")) {
      addLabels(evolution, "the template's regions", parcellated->folder / "regions.label.gii");
    }
  });
  return evolution;
}

/// Places that a reader must judge: where the surface was corrected, where there is no thickness,
/// where faces cross.
std::vector<report::CloseUp> placesToJudge(const ResultFolder& results,
                                           const std::vector<Hemisphere>& all) {
  std::vector<report::CloseUp> places;
  const auto add = [&](const Hemisphere& h, const char* what, std::vector<report::CloseUp> found) {
    for (report::CloseUp& place : found) {
      place.words = (h.side.empty() ? "" : h.side + ", ") + what + place.words;
      places.push_back(std::move(place));
    }
  };
  for (const Hemisphere& h : all) {
    if (const auto* unfold = results.beside(*h.step, "unfold")) {
      add(h, "self-intersection: ", crossingPlaces(crossingPairs(*unfold), kMostPlaces));
    }
    add(h, "topology corrected: ", correctedPlaces(*h.step, kMostPlaces));
    if (const auto* thickness = results.beside(*h.step, "thickness")) {
      add(h, "no thickness: ", unknownPlaces(*thickness, kMostPlaces));
    }
  }
  return places;
}

void showOutlines(ResultFolder& results, const std::vector<Hemisphere>& all,
                  const FolderReportOptions& options) {
  const auto image = imageOf(results, *all.front().step);
  if (!image) return;
  const Volume<float> volume = io::readScalars(*image, {.allowNonFinite = true}).volume;
  std::vector<report::MosaicOutline> outlines;
  for (const Hemisphere& h : all) {
    outlines.push_back({&h.white, "white surface", "#ff453a", h.side, "white"});
    outlines.push_back({&h.pial, "pial surface", "#ffd60a", h.side, "pial"});
  }
  TriangleMesh brain;
  std::optional<Volume<float>> inside;
  for (const StepFolder* segment : results.stepsOf("segment")) {
    if (!segment->has("brain_mask.nii.gz")) continue;
    brain = borderOf(segment->folder / "brain_mask.nii.gz");
    inside = brainOf(*segment, volume.grid);
  }
  report::MosaicOptions mosaic{.perRow = options.slices,
                               .convention = options.convention,
                               .subject = inside ? &*inside : nullptr};
  const std::vector<report::MosaicOutline> surfaces = outlines;
  report::MosaicOptions large = mosaic;
  large.perRow = 1;
  large.tileHeight = 380;
  report::SliceMosaic middle = report::makeMosaic(volume, outlines, large);
  results.content().glance.push_back(
      {kOutlinePlace,
       "Surfaces on the image",
       "Right: red between white and grey matter, yellow between grey matter and fluid, on every "
       "gyrus. Wrong: a line within one tissue, gyri cut off, skull or vessels included. Then: "
       "correct the segmentation there and run again.",
       {std::move(middle.rows[0][0]), std::move(middle.rows[1][0])},
       middle.outlines});
  const std::vector<report::CloseUp> places = placesToJudge(results, all);
  results.content().slices = {
      kOutlinePlace, "White and pial surface on " + image->filename().string(),
      "Lines between the voxels: the very surfaces, cut. Right, wrong and what to do: as at the "
      "head of the page.",
      middle.outlines, report::sliceStackJson(volume, outlines, places, mosaic)};
  if (brain.faceCount() > 0) outlines.push_back({&brain, "brain", "#5ac8fa"});
  results.content().mosaics.push_back({"", "The same for print",
                                       "The outlines must follow the borders of the grey ribbon.",
                                       report::makeMosaic(volume, outlines, mosaic)});
  if (places.empty()) return;
  report::MosaicOptions close = mosaic;
  close.tileHeight = 260;
  report::SliceMosaic doubted = report::makeCloseUps(volume, surfaces, {places.front()}, 36, close);
  results.content().glance.push_back(
      {kOutlinePlace,
       "First of " + std::to_string(places.size()) + " places to judge",
       "Right: the lines keep to the borders within the ring, too. Wrong: a bridge between two "
       "gyri, a hole, a cut through white matter. Then: step through all places in the slices and "
       "rate them.",
       {std::move(doubted.rows[0][0]), std::move(doubted.rows[1][0])},
       std::move(doubted.outlines)});
}

void chartSurfaceThickness(ResultFolder& results, const std::vector<Hemisphere>& all) {
  for (const Hemisphere& h : all) {
    const auto map = mapNamed(h.step->folder / "thickness.shape.gii", h.pial.vertexCount());
    if (!map) continue;
    std::vector<double> ribbon;
    for (const double t : map->values) {
      if (t > 0) ribbon.push_back(t);
    }
    results.content().charts.push_back(
        {"",
         report::histogramSvg(asVector(ribbon),
                              {"Cortical thickness" + (h.side.empty() ? "" : ", " + h.side),
                               "thickness [mm]", "share of vertices"}),
         kThicknessCharts});
  }
}

}  // namespace

void addLabels(report::Evolution& evolution, const std::string& title, const fs::path& file) {
  if (!isThere(file)) return;
  const io::LabelMap labels = io::readVertexLabels(file, evolution.mesh.vertexCount());
  report::EvolutionLabels named{title, {}, {}};
  std::map<Label, std::int32_t> entryOf;
  for (const io::LabelEntry& entry : labels.table) {
    if (entry.key == 0) continue;
    entryOf[entry.key] = static_cast<std::int32_t>(named.legend.size());
    named.legend.push_back({entry.name, report::colourOfLabel(entry.key, entry.colour)});
  }
  for (const Label key : labels.keys) {
    const auto found = entryOf.find(key);
    named.entries.push_back(found == entryOf.end() ? -1 : found->second);
  }
  evolution.labels.push_back(std::move(named));
}

void showSurfaces(ResultFolder& results, const FolderReportOptions& options,
                  const std::vector<GivenMap>& maps) {
  std::vector<Hemisphere> all;
  for (const StepFolder* step : results.stepsOf("surface")) {
    all.push_back({step, step->side(), io::readSurface(step->folder / "white.surf.gii").mesh,
                   io::readSurface(step->folder / "pial.surf.gii").mesh});
  }
  if (all.empty()) return;
  std::ranges::sort(all, {}, &Hemisphere::side);
  for (const Hemisphere& h : all) results.content().evolutions.push_back(brainOf(results, h));
  results.attempt("Outlines on the image", [&] { showOutlines(results, all, options); });
  results.attempt("Thickness map", [&] { showThickness(results, all); });
  for (const auto& [file, word] : {std::pair{"curvature.shape.gii", "mean curvature"},
                                   std::pair{"sulc.shape.gii", "sulcal depth"},
                                   std::pair{"doubt.shape.gii", "doubt of the borders"}}) {
    results.attempt(word,
                    [&, file = file, word = word] { (void)addMap(results, all, file, word); });
  }
  for (std::size_t h = 0; h < all.size(); ++h) {
    addGiven(results.content().evolutions[h], all[h].side, maps);
  }
  results.attempt("Thickness histogram", [&] { chartSurfaceThickness(results, all); });
}

}  // namespace explica::pipeline
