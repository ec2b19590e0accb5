// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "OpenedFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Report/SlicePicture.h"
#include "OpenedFolders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

viewer::Rgb bytesOf(const report::Colour& colour) {
  viewer::Rgb rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = report::encodeSrgb(colour[c]);
  return rgb;
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

}  // namespace

bool isVolume(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array kEndings = {".nii",  ".nii.gz", ".mgh", ".mgz", ".nrrd",
                                   ".nhdr", ".mha",    ".mhd", ".hdr", ".img"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](const char* ending) { return name.ends_with(ending); });
}

std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

viewer::WindowLabels windowLabels(const ShownSurface& surface, const fs::path& path) {
  const io::LabelMap read = readLabelsOn(surface, path);
  viewer::WindowLabels labels;
  labels.name = path.filename().string();
  labels.file = path.string();
  labels.keys.assign(read.keys.begin(), read.keys.end());
  for (const io::LabelEntry& entry : read.table) {
    labels.names.emplace_back(entry.key, entry.name);
    labels.colours.emplace_back(entry.key, bytesOf(report::colourOfLabel(entry.key, entry.colour)));
  }
  return labels;
}

viewer::Opened openForWindow(const fs::path& path, const ShownSurface& surface) {
  if (fs::is_directory(path)) return openFolder(path, surface);
  viewer::Opened opened;
  const std::string name = path.filename().string();
  if (isVolume(path)) {
    opened.slices = slicesOf(path);
    opened.what = name + ": slices through the point that is picked (C)";
  } else if (isLabelFile(path)) {
    opened.labels.push_back(windowLabels(surface, path));
    opened.what = name + ": " + counted(opened.labels[0].names.size(), "label");
  } else {
    for (io::VertexMap& map : readMapsOn(surface, path)) {
      const bool first = opened.maps.empty();
      // Some programs name a map by the path of the file that it came from.
      opened.maps.push_back({fs::path(map.name).filename().string(), map.unit,
                             std::move(map.values), first ? path.string() : ""});
    }
    opened.what = name + ": " + counted(opened.maps.size(), "map");
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
