// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"

namespace explica::python {
namespace {

/// The affine is the file's own, from which the reader made its grid: functions that are given it
/// make the same grid, to the last bit.
template <class T>
py::tuple volumeTuple(io::LoadedVolume<T> loaded) {
  return py::make_tuple(arrayOf(std::move(loaded.volume)), loaded.origin.affine);
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
  using namespace py::literals;
  m.def(
      "read_scalars",
      [](const std::string& path, const py::kwargs& keywords) {
        const auto options = optionsOf<io::VolumeReadOptions>(keywords);
        return volumeTuple(io::readScalars(path, options));
      },
      "path"_a,
      ("Image of scalars: (array (I, J, K) float32, affine (4, 4) index to RAS mm)." +
       keywordHelp<io::VolumeReadOptions>())
          .c_str());
  m.def(
      "read_labels",
      [](const std::string& path, const py::kwargs& keywords) {
        const auto options = optionsOf<io::VolumeReadOptions>(keywords);
        return volumeTuple(io::readLabels(path, options));
      },
      "path"_a,
      ("Segmentation: (array (I, J, K) int32, affine (4, 4) index to RAS mm)." +
       keywordHelp<io::VolumeReadOptions>())
          .c_str());
  m.def(
      "write_volume",
      [](const std::string& path, const py::array& values, const Eigen::Matrix4d& affine) {
        if (values.dtype().kind() == 'f') {
          io::writeVolume(path, scalarVolume(values, affine));
        } else {
          io::writeVolume(path, labelVolume(values, affine));
        }
      },
      "path"_a, "values"_a, "affine"_a,
      "Write an image; integers as labels, floating point as float32.  Format by the name.");
  m.def(
      "read_surface",
      [](const std::string& path, const py::kwargs& keywords) {
        auto loaded = io::readSurface(path, optionsOf<io::SurfaceReadOptions>(keywords));
        return py::make_tuple(py::cast(std::move(loaded.mesh.positions)),
                              py::cast(std::move(loaded.mesh.faces)));
      },
      "path"_a,
      ("Surface: (positions (V, 3) scanner RAS mm, faces (F, 3))." +
       keywordHelp<io::SurfaceReadOptions>())
          .c_str());
  m.def(
      "write_surface",
      [](const std::string& path, const Eigen::Ref<const Positions>& positions,
         const Eigen::Ref<const Faces>& faces, const std::string& structure,
         const std::string& secondary) {
        io::SurfaceMetadata metadata;
        metadata.structure = structure;
        metadata.secondary = secondary;
        io::writeSurface(path, meshOf(positions, faces), metadata);
      },
      "path"_a, "positions"_a, "faces"_a, "structure"_a = "Other", "secondary"_a = "",
      "Write a surface; format by the name (.surf.gii, .vtp, .ply, .obj, .off, .stl, FreeSurfer).");
  m.def(
      "read_vertex_maps",
      [](const std::string& path) {
        py::dict maps;
        for (auto& map : io::readVertexMaps(path)) maps[py::str(map.name)] = std::move(map.values);
        return maps;
      },
      "path"_a, "Per-vertex values by name: GIFTI, FreeSurfer curv, MGH, VTK.");
  m.def(
      "write_shape",
      [](const std::string& path, const py::dict& maps, const std::string& structure) {
        io::writeGiftiShape(path, mapsOf(maps), structure);
      },
      "path"_a, "maps"_a, "structure"_a = "Other",
      "Write per-vertex values {name: array (V,)} as GIFTI.");
}

}  // namespace explica::python
