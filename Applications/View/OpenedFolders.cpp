// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "OpenedFolders.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Pipeline/UnfoldingFolder.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Provenance/Verify.h"
#include "Explica/Unfolding/Region.h"
#include "OpenedFiles.h"

#include <Eigen/Geometry>

#include <numeric>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDistortion = "distortion.shape.gii";

/// Files that a folder's record names under a role, where they lie now and if they are there.
std::vector<fs::path> inputsOf(const fs::path& folder, std::string_view role) {
  std::vector<fs::path> found;
  const fs::path file = folder / provenance::kRecordName;
  if (!fs::exists(file)) return found;
  const auto record = provenance::readRecord(file);
  const auto inputs = record.value("inputs", provenance::Json::array());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].value("role", "") != role) continue;
    const auto path = provenance::locateInput(record, i, file);
    if (fs::exists(path)) found.push_back(path);
  }
  return found;
}

std::vector<fs::path> filesEnding(const fs::path& folder, std::string_view ending) {
  return entriesOf(folder, [&](const std::string& name) { return name.ends_with(ending); });
}

unfolding::Region regionOf(const fs::path& folder, const TriangleMesh& surface) {
  std::vector<bool> marked(static_cast<std::size_t>(surface.vertexCount()), false);
  for (const std::int32_t v : pipeline::unfoldedRegion(folder, surface.vertexCount())) {
    marked[v] = true;
  }
  return unfolding::regionOfMarked(surface, marked);
}

/// Viewpoints as a summary has them; none where it has none.
std::optional<visibility::Viewpoints> viewpointsIn(const provenance::Json& summary) {
  const auto numbers = summary.value("viewpoint", std::vector<double>());
  std::vector<Point> points;
  for (std::size_t n = 0; n + 3 <= numbers.size(); n += 3) {
    points.emplace_back(numbers[n], numbers[n + 1], numbers[n + 2]);
  }
  if (points.empty()) return {};
  return visibility::viewpoints(points, summary.value("viewpoint_weights", std::vector<double>()));
}

viewer::Finished readUnfolding(const fs::path& folder, const TriangleMesh& surface) {
  viewer::Finished finished;
  finished.region = regionOf(folder, surface);
  const auto summary = summaryOf(folder);
  finished.view = viewpointsIn(summary);
  const std::vector<fs::path> files = pipeline::frameFiles(folder);
  if (files.empty()) {
    viewer::Moment start;
    start.positions = surface.positions;
    start.record.visibility = summary.value("visibility_initial", kNaN);
    finished.moments.push_back(std::move(start));
  }
  for (std::size_t n = 0; n < files.size(); ++n) {
    viewer::Moment moment;
    moment.positions = io::readSurface(files[n]).mesh.positions;
    moment.record.visibility = pipeline::frameVisibility(summary, n);
    finished.moments.push_back(std::move(moment));
  }
  viewer::Moment last;
  last.positions = io::readSurface(folder / "unfolded.surf.gii").mesh.positions;
  last.record.visibility = summary.value("visibility_final", kNaN);
  last.record.areaErrorMean = summary.value("area_error_mean", kNaN);
  last.record.edgeStrainMean = summary.value("edge_strain_mean", kNaN);
  finished.moments.push_back(std::move(last));
  return finished;
}

/// A flat map turned and moved, not mirrored, to lie nearest to the folded patch.
Positions besidePatch(const Positions& flat, const Positions& folded) {
  const Eigen::Matrix4d placed = Eigen::umeyama(flat.transpose(), folded.transpose(), false);
  return ((flat * placed.topLeftCorner<3, 3>().transpose()).rowwise() +
          placed.topRightCorner<3, 1>().transpose())
      .eval();
}

/// The patch and its flat map as two states.
viewer::Finished readFlattening(const fs::path& folder, const TriangleMesh& patch) {
  viewer::Finished finished;
  finished.region.faces = patch.allFaces();
  finished.region.vertices.resize(static_cast<std::size_t>(patch.vertexCount()));
  std::iota(finished.region.vertices.begin(), finished.region.vertices.end(), 0);
  viewer::Moment folded, flat;
  for (viewer::Moment* moment : {&folded, &flat}) {
    moment->record.visibility = moment->record.areaErrorMean = moment->record.edgeStrainMean = kNaN;
  }
  folded.positions = patch.positions;
  const auto map = io::readSurface(folder / "patch_flat.surf.gii").mesh;
  flat.positions = besidePatch(map.positions, patch.positions);
  const auto summary = summaryOf(folder);
  flat.record.areaErrorMean = summary.value("area_error_mean", kNaN);
  flat.record.edgeStrainMean = summary.value("edge_strain_mean", kNaN);
  finished.moments = {std::move(folded), std::move(flat)};
  return finished;
}

/// Maps of a file under its name; of a series their mean.  Where `on` is given, they are known only
/// there.
void addMaps(const fs::path& file, const ShownSurface& surface, viewer::Opened& opened,
             const std::vector<bool>& on = {}) {
  if (fs::file_size(file) > io::kMostShown) return;
  std::vector<io::VertexMap> maps = readMapsOn(surface, file);
  std::string stem = file.filename().string();
  for (const std::string_view ending : {".gii", ".func", ".shape"}) {
    if (stem.ends_with(ending)) stem.resize(stem.size() - ending.size());
  }
  for (io::VertexMap& map : maps) {  // which may begin with the volume's name
    if (map.name.starts_with(stem + " ")) map.name.erase(0, stem.size() + 1);
  }
  if (maps.size() > 1 && maps.front().name.starts_with("frame")) {
    for (std::size_t n = 1; n < maps.size(); ++n) maps.front().values += maps[n].values;
    maps.front().values /= static_cast<double>(maps.size());
    maps.front().name = "mean of " + std::to_string(maps.size()) + " frames";
    maps.resize(1);
  }
  for (std::size_t n = 0; n < maps.size(); ++n) {
    for (std::size_t v = 0; v < on.size(); ++v) {
      if (!on[v]) maps[n].values[static_cast<Eigen::Index>(v)] = kNaN;
    }
    maps[n].name.insert(0, stem + " ");
    opened.maps.push_back({std::move(maps[n]), n == 0 ? file.string() : ""});
  }
}

ShownSurface patchOf(const fs::path& folder) {
  const fs::path file = folder / "patch.surf.gii";
  ShownSurface patch{io::readSurface(file).mesh, file.string()};
  const std::vector<io::VertexMap> places = io::readVertexMaps(folder / "vertex_of.shape.gii");
  for (const double v : places.front().values) {
    patch.origin.push_back(static_cast<std::int32_t>(v));
  }
  patch.wholeCount = io::readSurface(folder / "flat.surf.gii").mesh.vertexCount();
  Vector normal = Vector::Zero();
  for (Eigen::Index f = 0; f < patch.mesh.faceCount(); ++f) {
    const Point a = patch.mesh.corner(f, 0), b = patch.mesh.corner(f, 1),
                c = patch.mesh.corner(f, 2);
    normal += (b - a).cross(c - a);
  }
  if (normal.norm() > 0) patch.direction = normal.normalized();
  return patch;
}

void openFlattening(const fs::path& folder, const ShownSurface& surface, viewer::Opened& opened) {
  const bool isPatch = fs::path(surface.file) == folder / "patch.surf.gii";
  if (isPatch) opened.finished = readFlattening(folder, surface.mesh);
  if (isPatch) {
    for (const fs::path& file : inputsOf(folder, "map")) addMaps(file, surface, opened);
    for (const fs::path& file : inputsOf(folder, "regions")) {
      opened.labels.push_back(windowLabels(surface, file));
    }
    addMaps(folder / kDistortion, surface, opened);
  } else if (const ShownSurface patch = patchOf(folder);
             patch.wholeCount == surface.mesh.vertexCount()) {
    std::vector<bool> on(static_cast<std::size_t>(patch.wholeCount), false);
    for (const std::int32_t v : patch.origin) on[v] = true;
    addMaps(folder / kDistortion, surface, opened, on);
  }
}

void openSampling(const fs::path& folder, const ShownSurface& surface, viewer::Opened& opened) {
  const bool onSurface = !filesEnding(folder, ".func.gii").empty();
  for (const fs::path& file : onSurface ? inputsOf(folder, "labels") : std::vector<fs::path>{}) {
    opened.labels.push_back(windowLabels(surface, file));
  }
  for (const fs::path& file : filesEnding(folder, ".func.gii")) addMaps(file, surface, opened);
  for (const fs::path& file : filesEnding(folder, ".label.gii")) {
    opened.labels.push_back(windowLabels(surface, file));
  }
}

ShownSurface startOfUnfolding(const fs::path& folder) {
  const auto given = inputsOf(folder, "SURFACE");
  if (!given.empty()) return {io::readSurface(given.front()).mesh, given.front().string()};
  const auto frames = pipeline::frameFiles(folder);
  if (frames.empty()) {
    throw InvalidInput(folder.string() +
                       ": the surface that it began with is gone, and no frames were kept; name "
                       "the surface before the folder");
  }
  return {io::readSurface(frames.front()).mesh, frames.front().string()};
}

ShownSurface middleOf(const fs::path& folder) {
  const auto white = inputsOf(folder, "white"), pial = inputsOf(folder, "pial");
  if (white.empty() || pial.empty()) {
    throw InvalidInput(folder.string() +
                       ": the surfaces that were sampled are gone, or it was sampled in layers of "
                       "a tissue; name a surface before the folder");
  }
  ShownSurface middle{io::readSurface(white.front()).mesh, white.front().string()};
  const Positions outer = io::readSurface(pial.front()).mesh.positions;
  if (outer.rows() == middle.mesh.positions.rows()) {
    middle.mesh.positions = (0.5 * (middle.mesh.positions + outer)).eval();
  }
  return middle;
}

}  // namespace

provenance::Json summaryOf(const fs::path& folder) {
  const fs::path file = folder / provenance::kSummaryName;
  return fs::exists(file) ? provenance::readJson(file) : provenance::Json::object();
}

bool isUnfolding(const fs::path& folder) {
  return fs::exists(folder / "unfolded.surf.gii") && fs::exists(folder / "region.label.gii");
}

bool isFlattening(const fs::path& folder) {
  return fs::exists(folder / "patch_flat.surf.gii") && fs::exists(folder / "vertex_of.shape.gii");
}

bool isSampling(const fs::path& folder) {
  return fs::is_directory(folder) &&
         (fs::exists(folder / "profiles.tsv") || !filesEnding(folder, "_layers.tsv").empty());
}

std::optional<ShownSurface> surfaceOfFolder(const fs::path& folder) {
  if (isUnfolding(folder)) return startOfUnfolding(folder);
  if (isFlattening(folder)) return patchOf(folder);
  if (isSampling(folder)) return middleOf(folder);
  return {};
}

viewer::Opened openFolder(const fs::path& folder, const ShownSurface& surface) {
  viewer::Opened opened;
  const std::string name = folder.filename().string() + ": ";
  if (isUnfolding(folder)) {
    opened.finished = readUnfolding(folder, surface.mesh);
    opened.what = name + counted(opened.finished->moments.size(), "state");
  } else if (isFlattening(folder)) {
    openFlattening(folder, surface, opened);
    opened.what = name + counted(opened.maps.size(), "map");
  } else if (isSampling(folder)) {
    openSampling(folder, surface, opened);
    opened.what = name + counted(opened.maps.size(), "map");
  } else {
    throw InvalidInput(folder.string() + ": is no folder of explica unfold, flatten or sample");
  }
  return opened;
}

}  // namespace explica::app
