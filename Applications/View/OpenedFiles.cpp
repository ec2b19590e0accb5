// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "OpenedFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Pipeline/UnfoldingFolder.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Provenance/Verify.h"
#include "Explica/Report/SlicePicture.h"
#include "Explica/Unfolding/Region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

bool endsWith(const std::string& name, std::string_view ending) {
  return name.size() >= ending.size() &&
         name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

viewer::Rgb bytesOf(const report::Colour& colour) {
  viewer::Rgb rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = report::encodeSrgb(colour[c]);
  return rgb;
}

unfolding::Region regionOf(const fs::path& folder, const TriangleMesh& surface) {
  std::vector<bool> marked(static_cast<std::size_t>(surface.vertexCount()), false);
  for (const std::int32_t v : pipeline::unfoldedRegion(folder, surface.vertexCount())) {
    marked[v] = true;
  }
  return unfolding::regionOfMarked(surface, marked);
}

viewer::Finished readFinished(const fs::path& folder, const TriangleMesh& surface) {
  viewer::Finished finished;
  finished.region = regionOf(folder, surface);
  const auto summary = provenance::readJson(folder / provenance::kSummaryName);
  std::vector<fs::path> files = pipeline::frameFiles(folder);
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

viewer::WindowLabels readLabels(const fs::path& path, const TriangleMesh& surface) {
  const io::LabelMap read = io::readVertexLabels(path, surface.vertexCount());
  viewer::WindowLabels labels;
  labels.name = path.filename().string();
  labels.file = path.string();
  labels.keys.assign(read.keys.begin(), read.keys.end());
  for (const io::LabelEntry& entry : read.table) {
    labels.names.emplace_back(entry.key, entry.name);
    const auto& c = entry.colour;
    const bool own = c[0] + c[1] + c[2] > 0;
    viewer::Rgb rgb = bytesOf(report::colourOfLabel(entry.key));
    for (int k = 0; k < 3 && own; ++k) {
      rgb[k] = static_cast<unsigned char>(std::lround(255 * std::clamp(c[k], 0.0F, 1.0F)));
    }
    labels.colours.emplace_back(entry.key, rgb);
  }
  return labels;
}

/// What a volume's slices are drawn from.
struct SliceSource {
  Volume<float> image;
  Point low = Point::Constant(kInfinity);
  Point high = Point::Constant(-kInfinity);
  report::ColourScale grey{report::ColourMap::Grey, 0, 1, "", ""};
};

std::shared_ptr<const SliceSource> readSliceSource(const fs::path& path) {
  auto source = std::make_shared<SliceSource>();
  io::VolumeReadOptions reading;
  reading.allowNonFinite = true;
  source->image = io::readScalars(path, reading).volume;
  const auto& size = source->image.grid.size;
  for (int corner = 0; corner < 8; ++corner) {
    const Point p = source->image.grid.toWorld(Vector((corner & 1) != 0 ? size[0] - 1 : 0,
                                                      (corner & 2) != 0 ? size[1] - 1 : 0,
                                                      (corner & 4) != 0 ? size[2] - 1 : 0));
    source->low = source->low.cwiseMin(p);
    source->high = source->high.cwiseMax(p);
  }
  std::vector<float> values;
  for (const float v : source->image.data) {
    if (std::isfinite(v)) values.push_back(v);
  }
  if (values.empty()) throw InvalidInput(path.string() + ": holds no finite value");
  std::sort(values.begin(), values.end());
  source->grey.low = values[values.size() / 200];
  source->grey.high = values[values.size() - 1 - values.size() / 200];
  if (!(source->grey.high > source->grey.low)) source->grey.high = source->grey.low + 1;
  return source;
}

viewer::SlicePixels drawSlice(const SliceSource& source, int axis, const Point& through,
                              const TriangleMesh& surface) {
  constexpr int kHeight = 320;
  constexpr std::array kAxes = {report::SliceAxis::Sagittal, report::SliceAxis::Coronal,
                                report::SliceAxis::Axial};
  const report::SliceFrame frame =
      report::frameAround(kAxes[axis], through[axis] + 1e-4, source.low, source.high, kHeight);
  const report::Picture picture =
      report::renderSlice(source.image, frame, source.grey, {{&surface, {1, 0.75F, 0}, 1.2}});
  viewer::SlicePixels pixels;
  pixels.width = picture.width;
  pixels.height = picture.height;
  pixels.rgb = picture.rgb;
  const int across = axis == 0 ? 1 : 0, along = axis == 2 ? 1 : 2;
  pixels.right[across] = (axis == 0 ? -1 : 1) * frame.pixel;
  pixels.down[along] = -frame.pixel;
  Point centre = through;
  centre[across] = frame.centre[0];
  centre[along] = frame.centre[1];
  pixels.topLeft =
      centre - (0.5 * frame.width - 0.5) * pixels.right - (0.5 * frame.height - 0.5) * pixels.down;
  return pixels;
}

viewer::DrawSlice slicesOf(const fs::path& path) {
  return [source = readSliceSource(path)](int axis, const Point& through,
                                          const TriangleMesh& surface) {
    return drawSlice(*source, axis, through, surface);
  };
}

bool isLabelFile(const std::string& name) {
  return endsWith(name, ".label.gii") || endsWith(name, ".annot") || endsWith(name, ".label");
}

}  // namespace

bool isVolume(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array kEndings = {".nii",  ".nii.gz", ".mgh", ".mgz", ".nrrd",
                                   ".nhdr", ".mha",    ".mhd", ".hdr", ".img"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](const char* ending) { return endsWith(name, ending); });
}

bool isUnfolding(const fs::path& folder) {
  return fs::exists(folder / "unfolded.surf.gii") && fs::exists(folder / "region.label.gii");
}

StartingSurface startOfUnfolding(const fs::path& folder) {
  if (fs::exists(folder / provenance::kRecordName)) {
    const auto record = provenance::readRecord(folder / provenance::kRecordName);
    const auto inputs = record.value("inputs", provenance::Json::array());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (inputs[i].value("role", "") != "SURFACE") continue;
      const auto file = provenance::locateInput(record, i, folder / provenance::kRecordName);
      if (fs::exists(file)) return {io::readSurface(file).mesh, file.string()};
    }
  }
  const auto frames = pipeline::frameFiles(folder);
  if (frames.empty()) {
    throw InvalidInput(folder.string() +
                       ": the surface that it began with is gone, and no frames were kept; name "
                       "the surface before the folder");
  }
  return {io::readSurface(frames.front()).mesh, frames.front().string()};
}

viewer::Opened openForWindow(const fs::path& path, const TriangleMesh& surface) {
  viewer::Opened opened;
  const std::string name = path.filename().string();
  if (fs::is_directory(path)) {
    if (!isUnfolding(path)) {
      throw InvalidInput(path.string() + ": is no folder of explica unfold");
    }
    opened.finished = readFinished(path, surface);
    opened.what = name + ": " + std::to_string(opened.finished->moments.size()) + " states";
  } else if (isVolume(path)) {
    opened.slices = slicesOf(path);
    opened.what = name + ": slices through the point that is picked (C)";
  } else if (isLabelFile(name)) {
    opened.labels.push_back(readLabels(path, surface));
    opened.what = name + ": " + std::to_string(opened.labels[0].names.size()) + " labels";
  } else {
    for (io::VertexMap& map : io::readVertexMaps(path, surface.vertexCount())) {
      opened.maps.push_back({map.name, map.unit, std::move(map.values)});
    }
    opened.what = name + ": " + std::to_string(opened.maps.size()) + " maps";
  }
  return opened;
}

viewer::Scale scaleOf(const Eigen::VectorXd& values) {
  constexpr int kColours = 256;
  const report::ColourScale chosen = report::scaleFor(values, "", "");
  viewer::Scale scale;
  scale.low = chosen.low;
  scale.high = chosen.high;
  for (int n = 0; n < kColours; ++n) {
    scale.colours.push_back(
        bytesOf(report::colourAt(chosen.map, static_cast<double>(n) / (kColours - 1))));
  }
  scale.unknown = bytesOf(report::colourAt(chosen.map, kNaN));
  return scale;
}

}  // namespace explica::app
