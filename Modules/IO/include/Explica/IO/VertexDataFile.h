// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace explica::io {

/// One value a vertex (or a face, where a writer says so).
struct VertexMap {
  std::string name;        ///< "thickness"
  std::string unit;        ///< "mm", "mm^-1", "" if none
  Eigen::VectorXd values;  ///< V
};

/// What a key of a LabelMap stands for.
struct LabelEntry {
  Label key = 0;
  std::string name;
  std::array<float, 4> colour = {0, 0, 0, 0};  ///< red, green, blue, opacity in [0, 1]
};

/// One label a vertex, and the table of names.
struct LabelMap {
  std::string name;
  Eigen::Matrix<Label, Eigen::Dynamic, 1> keys;  ///< V
  std::vector<LabelEntry> table;                 ///< ascending keys
};

/// Of a file of maps, bytes: larger ones are not read whole where they would only be shown.
inline constexpr std::uintmax_t kMostShown = 200u << 20;

/// Reads per-vertex values: GIFTI (.shape.gii, .func.gii and so on, any encoding, also .gz),
/// FreeSurfer curv (old and new), MGH/MGZ with one value a vertex, point data of VTK files.  Where
/// a file states no unit, its name may: `lh.thickness`, `..._thickness.shape.gii` are in mm.
///
/// @param vertexCount  demanded number of values a map, if given
/// @throws IOError       missing, truncated or of no known format
/// @throws InvalidInput  no per-vertex values in it, or not `vertexCount` of them
[[nodiscard]] std::vector<VertexMap> readVertexMaps(const std::filesystem::path& path,
                                                    std::optional<Eigen::Index> vertexCount = {});

/// Reads one label a vertex: GIFTI label, FreeSurfer annot, FreeSurfer label (a list of vertices:
/// key 1 on the list and 0 off it; needs `vertexCount`).
///
/// @throws as readVertexMaps; InvalidInput also for a vertex list without `vertexCount` or beyond
/// it
[[nodiscard]] LabelMap readVertexLabels(const std::filesystem::path& path,
                                        std::optional<Eigen::Index> vertexCount = {});

/// Writes GIFTI metric data: FLOAT32, gzip-base64, one array a map; Workbench wants `.shape.gii` or
/// `.func.gii`.  Not-a-number, which Workbench's statistics cannot bear, is written as 0 (the
/// reader of the map needs a mask of where it holds).
/// @return how many values were not finite and became 0
/// @throws InvalidInput      no map, or maps of different length
/// @throws EnvironmentError  the file cannot be written
Eigen::Index writeGiftiShape(const std::filesystem::path& path, const std::vector<VertexMap>& maps,
                             const std::string& structure);

/// Writes GIFTI metric data map by map, so that memory holds one at a time: FLOAT32, gzip-base64.
/// Not-a-number stays, for maps of which some values are not known.
class GiftiMapsWriter {
 public:
  /// @param mapCount      how many maps will be added
  /// @param secondsApart  time from map to map of a series; they are then marked as one
  GiftiMapsWriter(const std::filesystem::path& path, const std::string& structure,
                  std::size_t mapCount, std::optional<double> secondsApart = {});
  ~GiftiMapsWriter();
  GiftiMapsWriter(GiftiMapsWriter&&) noexcept;

  /// @throws EnvironmentError  the file cannot be written
  void add(const std::string& name, const std::string& unit, std::span<const float> values);
  /// Puts the file in place; without it there is none.
  /// @throws InvalidInput  fewer or more maps than announced
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes GIFTI labels: INT32 keys and the table; Workbench wants `.label.gii`.
/// @throws InvalidInput      a key that the table lacks
/// @throws EnvironmentError  the file cannot be written
void writeGiftiLabel(const std::filesystem::path& path, const LabelMap& labels,
                     const std::string& structure);

/// Writes FreeSurfer's new curv format (`lh.thickness`): big-endian float32.
void writeFreeSurferCurv(const std::filesystem::path& path, const Eigen::VectorXd& values,
                         Eigen::Index faceCount);

/// Writes FreeSurfer's annot format with its colour table; keys become places in the table, as
/// nibabel takes them.  Negative ones of no colour are vertices without a label.
void writeFreeSurferAnnot(const std::filesystem::path& path, const LabelMap& labels);

}  // namespace explica::io
