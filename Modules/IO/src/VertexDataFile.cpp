// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/VertexDataFile.h"

#include "ByteSource.h"
#include "FreeSurferFormat.h"
#include "GiftiFormat.h"
#include "PlainMeshFormats.h"
#include "SurfaceFrame.h"
#include "VertexFileEnding.h"
#include "VolumeFormats.h"
#include "VtkFormat.h"

#include "Explica/IO/VolumeSeries.h"

#include <array>

namespace explica::io {
namespace {

/// FreeSurfer keeps overlays as volumes of V x 1 x 1 voxels, one frame a map.
std::vector<VertexMap> readMghOverlay(const std::filesystem::path& path) {
  constexpr int kMostFrames = 100'000;  // of a series; what is longer is damaged
  VolumeSeries series(path);
  if (series.grid().size[1] != 1 || series.grid().size[2] != 1) {
    refuse(path, "is a volume; one value a vertex is needed");
  }
  if (series.frames() > kMostFrames) {
    refuse(path, "holds " + std::to_string(series.frames()) + " maps; up to " +
                     std::to_string(kMostFrames) + " are read");
  }
  std::vector<VertexMap> maps;
  for (std::vector<float> frame = series.next(1); !frame.empty(); frame = series.next(1)) {
    const Eigen::Map<const Eigen::VectorXf> values(frame.data(),
                                                   static_cast<Eigen::Index>(frame.size()));
    maps.push_back({path.stem().string(), "", values.cast<double>()});
  }
  return maps;
}

void checkCount(const std::filesystem::path& path, Eigen::Index found,
                std::optional<Eigen::Index> wanted) {
  if (wanted && found != *wanted) {
    refuse(path, "holds " + std::to_string(found) + " values, but the surface has " +
                     std::to_string(*wanted) +
                     " vertices: it belongs to another surface; give that one, or bring it "
                     "over with explica resample");
  }
}

/// Of the maps that FreeSurfer and sMRIPrep write, by the last word of the file's name; empty for
/// others.
std::string unitByName(const std::filesystem::path& path) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kUnits = {
      {{"thickness", "mm"},
       {"sulc", "mm"},
       {"curv", "mm^-1"},
       {"area", "mm^2"},
       {"volume", "mm^3"}}};
  std::string name = path.filename().string();
  name.resize(name.size() - vertexFileEnding(name).size());
  const std::string word = name.substr(name.find_last_of("._") + 1);
  for (const auto& [known, unit] : kUnits) {
    if (word == known) return std::string(unit);
  }
  return {};
}

}  // namespace

std::vector<VertexMap> readVertexMaps(const std::filesystem::path& path,
                                      std::optional<Eigen::Index> vertexCount) {
  ByteSource source(path);
  const ByteView first = source.peek(64);
  std::vector<VertexMap> maps;
  if (looksLikeMgh(first)) {
    maps = readMghOverlay(path);
  } else {
    const Bytes bytes = source.rest();
    if (looksLikeGifti(bytes)) {
      maps = readGiftiMaps(path, bytes);
    } else if (looksLikeVtk(bytes)) {
      maps = readPolyData(path, bytes).pointMaps;
    } else if (looksLikePly(bytes)) {
      maps = readPly(path, bytes).maps;
    } else if (freeSurferKindOf(bytes) == FreeSurferKind::Curv || looksLikeOldCurv(bytes)) {
      maps = {readFreeSurferCurv(path, bytes)};
    } else if (freeSurferKindOf(bytes) == FreeSurferKind::Surface && bytes[2] == 0xff &&
               load<std::int32_t>(bytes.data() + 11, true) == 1) {
      // A curv file by its header, whose length does not fit.
      failTruncated(path, "the file ends too early for its number of values");
    } else {
      failToRead(path,
                 "holds no per-vertex values of a known format (GIFTI, FreeSurfer curv, MGH, VTK)");
    }
  }
  if (maps.empty()) refuse(path, "holds no per-vertex values");
  for (VertexMap& map : maps) {
    checkCount(path, map.values.size(), vertexCount);
    if (map.unit.empty()) map.unit = unitByName(path);
  }
  return maps;
}

LabelMap readVertexLabels(const std::filesystem::path& path,
                          std::optional<Eigen::Index> vertexCount) {
  const Bytes bytes = ByteSource(path).rest();
  LabelMap labels;
  const bool listed = !bytes.empty() && (bytes[0] == '#' || path.extension() == ".label");
  if (looksLikeGifti(bytes)) {
    labels = readGiftiLabels(path, bytes);
  } else if (listed) {
    labels = readFreeSurferLabel(path, bytes, vertexCount);
  } else if (looksLikeAnnot(bytes)) {
    labels = readFreeSurferAnnot(path, bytes);
  } else {
    failToRead(path, "holds no labels of a known format (GIFTI, FreeSurfer label or annot)");
  }
  checkCount(path, labels.keys.size(), vertexCount);
  return labels;
}

}  // namespace explica::io
