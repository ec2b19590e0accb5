// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Report/ColourMap.h"

#include <algorithm>

namespace explica::python {
namespace {

using namespace py::literals;

/// The affine is the file's own, from which the reader made its grid: functions that are given it
/// make the same grid, to the last bit.
template <class T>
std::pair<py::array, Eigen::Matrix4d> volumePair(io::LoadedVolume<T> loaded) {
  return {arrayOf(std::move(loaded.volume)), loaded.origin.affine};
}

py::dict labelsDict(const io::LabelMap& labels) {
  py::dict names, colours;
  for (const io::LabelEntry& entry : labels.table) {
    names[py::int_(entry.key)] = entry.name;
    colours[py::int_(entry.key)] = entry.colour;
  }
  return py::dict("keys"_a = labels.keys, "names"_a = names, "colours"_a = colours);
}

io::LabelMap labelsOf(const Eigen::Matrix<Label, Eigen::Dynamic, 1>& keys, const py::dict& names) {
  io::LabelMap labels{"labels", keys, {}};
  for (const auto& [key, name] : names) {
    io::LabelEntry entry{key.cast<Label>(), name.cast<std::string>()};
    if (entry.key != 0) {
      const report::Colour c = report::colourOfLabel(entry.key);
      entry.colour = {c[0], c[1], c[2], 1};
    }
    labels.table.push_back(entry);
  }
  std::sort(labels.table.begin(), labels.table.end(),
            [](const auto& a, const auto& b) { return a.key < b.key; });
  return labels;
}

std::vector<io::VertexMap> mapsOf(const py::dict& maps) {
  std::vector<io::VertexMap> list;
  for (const auto& [name, values] : maps) {
    list.push_back({name.cast<std::string>(), "", values.cast<Eigen::VectorXd>()});
  }
  return list;
}

}  // namespace

void bindIO(py::module_& m) {
  defWithOptions<io::VolumeReadOptions>(
      m, "read_scalars",
      [](const std::filesystem::path& path, const py::kwargs& keywords) {
        const auto options = optionsOf<io::VolumeReadOptions>(keywords);
        return volumePair(io::readScalars(path, options));
      },
      "Image of scalars: (array (I, J, K) float32, affine (4, 4) index to RAS mm).", "path"_a);
  defWithOptions<io::VolumeReadOptions>(
      m, "read_labels",
      [](const std::filesystem::path& path, const py::kwargs& keywords) {
        const auto options = optionsOf<io::VolumeReadOptions>(keywords);
        return volumePair(io::readLabels(path, options));
      },
      "Segmentation: (array (I, J, K) int32, affine (4, 4) index to RAS mm).", "path"_a);
  m.def(
      "write_volume",
      [](const std::filesystem::path& path, const py::array& values,
         const Eigen::Matrix4d& affine) {
        if (values.dtype().kind() == 'f') {
          io::writeVolume(path, scalarVolume(values, affine));
        } else {
          io::writeVolume(path, labelVolume(values, affine));
        }
      },
      "path"_a, "values"_a, "affine"_a,
      "Write an image; integers as labels, floating point as float32.  Format by the name.");
  defWithOptions<io::SurfaceReadOptions>(
      m, "read_surface",
      [](const std::filesystem::path& path, const py::kwargs& keywords) {
        auto loaded = io::readSurface(path, optionsOf<io::SurfaceReadOptions>(keywords));
        return std::make_pair(std::move(loaded.mesh.positions), std::move(loaded.mesh.faces));
      },
      "Surface: (positions (V, 3) scanner RAS mm, faces (F, 3)).", "path"_a);
  std::string endings;
  for (const std::string& ending : io::surfaceEndings()) endings += ending + ", ";
  m.def(
      "write_surface",
      [](const std::filesystem::path& path, const Eigen::Ref<const Positions>& positions,
         const Eigen::Ref<const Faces>& faces, const std::string& structure,
         const std::string& secondary) {
        io::SurfaceMetadata metadata;
        metadata.structure = structure;
        metadata.secondary = secondary;
        io::writeSurface(path, meshOf(positions, faces), metadata);
      },
      "path"_a, "positions"_a, "faces"_a, "structure"_a = "Other", "secondary"_a = "",
      ("Write a surface; format by the name (" + endings + "FreeSurfer's for any other).").c_str());
  m.def(
      "read_vertex_maps",
      [](const std::filesystem::path& path) {
        py::dict maps;
        for (auto& map : io::readVertexMaps(path)) maps[py::str(map.name)] = std::move(map.values);
        return maps;
      },
      "path"_a, "Per-vertex values by name: GIFTI, FreeSurfer curv, MGH, VTK.");
  m.def(
      "write_shape",
      [](const std::filesystem::path& path, const py::dict& maps, const std::string& structure) {
        io::writeGiftiShape(path, mapsOf(maps), structure);
      },
      "path"_a, "maps"_a, "structure"_a = "Other",
      "Write per-vertex values {name: array (V,)} as GIFTI.");
  m.def(
      "read_vertex_labels",
      [](const std::filesystem::path& path, std::optional<Eigen::Index> vertexCount) {
        return labelsDict(io::readVertexLabels(path, vertexCount));
      },
      "path"_a, "vertex_count"_a = py::none(),
      "One label a vertex of a GIFTI label, FreeSurfer annot or FreeSurfer label file (a list of\n"
      "vertices, which needs vertex_count): keys (V,), names and colours, dictionaries by key.");
  m.def(
      "write_label",
      [](const std::filesystem::path& path, const Eigen::Matrix<Label, Eigen::Dynamic, 1>& keys,
         const py::dict& names, const std::string& structure) {
        io::writeGiftiLabel(path, labelsOf(keys, names), structure);
      },
      "path"_a, "keys"_a, "names"_a, "structure"_a = "Other",
      "Write one label a vertex, keys (V,), and what they are called {key: name}, as GIFTI.");
  m.def(
      "write_curv",
      [](const std::filesystem::path& path, const Eigen::VectorXd& values, Eigen::Index faceCount) {
        io::writeFreeSurferCurv(path, values, faceCount);
      },
      "path"_a, "values"_a, "face_count"_a,
      "Write one value a vertex (V,) as FreeSurfer does thickness and curvature.");
}

}  // namespace explica::python
