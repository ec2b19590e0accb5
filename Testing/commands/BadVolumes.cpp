// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "BadVolumes.h"

#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace explica::testing {
namespace {

/// The least of a NIfTI-1 file: 348 bytes of header, 4 of extension flag, float32 voxels.
struct RawNifti {
  std::vector<int> size = {6, 5, 4};
  std::array<std::array<float, 4>, 3> sform = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  short sformCode = 1;
  short qformCode = 0;
  std::array<float, 3> qOffset = {0, 0, 0};
  std::function<float(std::size_t voxel)> value = [](std::size_t v) { return float(v % 4); };

  void write(const std::string& path) const {
    std::string header(352, '\0');
    const auto put = [&header](std::size_t at, auto number) {
      std::memcpy(header.data() + at, &number, sizeof number);
    };
    put(0, std::int32_t{348});
    put(40, static_cast<std::int16_t>(size.size()));
    std::size_t voxels = 1;
    for (std::size_t axis = 0; axis < 7; ++axis) {
      const int extent = axis < size.size() ? size[axis] : 1;
      put(42 + 2 * axis, static_cast<std::int16_t>(extent));
      put(80 + 4 * axis, 1.0f);
      voxels *= static_cast<std::size_t>(extent);
    }
    put(70, std::int16_t{16});  // float32
    put(72, std::int16_t{32});
    put(76, 1.0f);
    put(108, 352.0f);
    put(112, 1.0f);
    header[123] = 2;  // mm
    put(252, qformCode);
    put(254, sformCode);
    for (std::size_t axis = 0; axis < 3; ++axis) put(268 + 4 * axis, qOffset[axis]);
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        put(280 + 16 * row + 4 * column, sform[row][column]);
      }
    }
    std::memcpy(header.data() + 344, "n+1", 4);
    for (std::size_t v = 0; v < voxels; ++v) {
      const float number = value(v);
      header.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
    writeText(path, header);
  }
};

}  // namespace

const std::vector<BadVolume>& badVolumes() {
  static const std::vector<BadVolume> volumes = {
      {"Missing", "absent.nii.gz", [](const std::string&) {}, {"no such file"}},
      {"TruncatedGzip",
       "truncated.nii.gz",
       [](const std::string& path) {
         Grid grid;
         grid.size = {12, 12, 12};
         Volume<float> volume(grid);
         for (std::size_t v = 0; v < volume.size(); ++v) volume[v] = std::sin(float(v * v));
         io::writeVolume(path, volume);
         std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
       },
       {"truncated", "copy or make it again"}},
      {"TruncatedPlain",
       "truncated.nii",
       [](const std::string& path) {
         RawNifti{}.write(path);
         std::filesystem::resize_file(path, 500);
       },
       {"truncated", "copy or make it again"}},
      {"NotAnImage",
       "letter.nii.gz",
       [](const std::string& path) { writeText(path, "Dear reader, this is a letter.\n"); },
       {}},
      {"Empty", "empty.nii", [](const std::string& path) { writeText(path, ""); }, {}},
      {"TwoDimensional",
       "flat.nii",
       [](const std::string& path) {
         RawNifti flat;
         flat.size = {6, 5};
         flat.write(path);
       },
       {}},
      {"FourDimensional",
       "series.nii",
       [](const std::string& path) {
         RawNifti series;
         series.size = {6, 5, 4, 3};
         series.write(path);
       },
       {"--frame"}},
      {"AllZero",
       "zero.nii",
       [](const std::string& path) {
         RawNifti zero;
         zero.value = [](std::size_t) { return 0.f; };
         zero.write(path);
       },
       {"every voxel"}},
      {"NotANumber",
       "nan.nii",
       [](const std::string& path) {
         RawNifti holed;
         holed.value = [](std::size_t v) { return v == 7 ? std::nanf("") : 1.f; };
         holed.write(path);
       },
       {}},
      {"ShearedSform",
       "sheared.nii",
       [](const std::string& path) {
         RawNifti sheared;
         sheared.sform[0][1] = 0.3f;
         sheared.write(path);
       },
       {"shear"}},
      {"PlacementsDiffer",
       "contradictory.nii",
       [](const std::string& path) {
         RawNifti twofold;
         twofold.qformCode = 1;
         twofold.sformCode = 2;
         twofold.qOffset = {30, 0, 0};
         twofold.write(path);
       },
       {"--xform"}},
  };
  return volumes;
}

}  // namespace explica::testing
