// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/VolumeOnDemand.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::io {

/// Which of a NIfTI header's two placements to believe.
enum class PlacementChoice {
  Agreed,  ///< the one that is set, or both where they agree; refuse where they differ
  Qform,   ///< quaternion
  Sform,   ///< matrix
  None,    ///< neither: voxel (0, 0, 0) at 0 mm and axes along R, A, S
};
constexpr auto enumWords(PlacementChoice) {
  using enum PlacementChoice;
  return std::to_array<EnumWord<PlacementChoice>>(
      {{Agreed, "agreed"}, {Qform, "qform"}, {Sform, "sform"}, {None, "none"}});
}

/// What readers do about files that leave something open, and which files they refuse.
struct VolumeReadOptions {
  PlacementChoice placement = PlacementChoice::Agreed;
  std::optional<int> frame =
      std::nullopt;  ///< which volume of a file with several, from 0; refused if unset
  std::optional<int> dimension = std::nullopt;  ///< 2 or 3: refuse volumes of the other kind
  bool allowNonFinite = false;                  ///< else NaN and infinity are refused
  bool allowAllZero = false;  ///< else a volume without any non-zero voxel is refused
};

template <class Visitor>
void describe(VolumeReadOptions& options, Visitor&& visit) {
  visit(Field{"xform", "", "which placement of a NIfTI header to believe where the two differ"},
        options.placement);
  visit(Field{"frame", "", "which volume of a file that holds several, counted from 0", 0, 1e6},
        options.frame);
}

/// VolumeOrigin::placement of a volume whose header does not say where its voxels lie.
inline constexpr const char* kNotPlaced = "none";

/// Where a volume came from and how its file was understood; goes into the provenance record.
struct VolumeOrigin {
  std::filesystem::path path;
  std::string format;           ///< "NIfTI-1", "NIfTI-2", "MGH", "NRRD", "MetaImage", "PNG"
  std::string storedType;       ///< "uint8", "float32", ...
  std::vector<int> storedSize;  ///< as the file has it, all dimensions
  std::string placement;        ///< "sform", "qform", "sform and qform agree", "none", "header"
  std::optional<int> qformCode = std::nullopt;  ///< NIfTI only
  std::optional<int> sformCode = std::nullopt;  ///< NIfTI only
  double placementsApart = 0;  ///< voxels between qform and sform, where they differ and one of
                               ///< them was chosen; else 0
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();  ///< index to RAS mm that was used
  std::vector<std::string>
      notes;  ///< facts that a user may want to know: defaults, units converted
};

template <class T>
struct LoadedVolume {
  Volume<T> volume;
  VolumeOrigin origin;
};

/// Reads a file of scalars: NIfTI-1/2 (.nii, .nii.gz, .hdr/.img), MGH/MGZ, NRRD,
/// MetaImage, 8- or 16-bit grey PNG (2D).  The format is recognised by content, not by name. Stored
/// values are scaled by the header's slope and intercept.
///
/// @return values on a grid in RAS mm, i fastest as in the file; a file of one slice gives a 2D
/// grid
/// @throws IOError       missing, unreadable, truncated or not an image: names path and cause
/// @throws InvalidInput  readable, but not usable as asked: several volumes without `frame`, the
/// other
///                       dimension, NaN, all zero, colour, sheared axes, placements that differ, or
///                       a voxel size of 0; says what to do
[[nodiscard]] LoadedVolume<float> readScalars(const std::filesystem::path& path,
                                              const VolumeReadOptions& options = {});

/// Reads a file of labels.  Floating-point files are accepted if every value is a whole number.
/// @throws as readScalars, and InvalidInput for a value that is no whole number of 32 bits
[[nodiscard]] LoadedVolume<Label> readLabels(const std::filesystem::path& path,
                                             const VolumeReadOptions& options = {});

/// Reads three values a voxel: I x J x K x 3, or I x J x K x 1 x 3, or three components (NRRD,
/// MetaImage).  Components are taken as they stand, which is RAS for our own files.
/// @throws as readScalars, and InvalidInput if there are not three values a voxel
[[nodiscard]] LoadedVolume<Eigen::Vector3f> readVectors(const std::filesystem::path& path,
                                                        const VolumeReadOptions& options = {});

/// Grid of a file, without its voxels.
[[nodiscard]] Grid readGrid(const std::filesystem::path& path,
                            const VolumeReadOptions& options = {});

/// Writes a volume whole or not at all; the format follows the name: .nii, .nii.gz, .mgh, .mgz,
/// .nrrd, .mha.  NIfTI files carry equal qform and sform, both with code 1 (scanner); the sform
/// alone where float32 cannot hold the qform's rotation (tilts of 1e-5 to 1e-3 from a half turn).
/// Scalars are stored as float32, labels in the smallest of uint8, int16, int32 that holds them
/// all.  The bytes depend on the values only, not on the number of threads nor on the time of day.
///
/// @throws InvalidInput      unknown extension, empty grid
/// @throws EnvironmentError  the file cannot be written
void writeVolume(const std::filesystem::path& path, const Volume<float>& volume);
void writeVolume(const std::filesystem::path& path, const Volume<double>& volume);
void writeVolume(const std::filesystem::path& path, const Volume<Label>& volume);
void writeVolume(const std::filesystem::path& path, const Volume<std::uint8_t>& volume);
void writeVolume(const std::filesystem::path& path, const VolumeOnDemand<float>& volume);
void writeVolume(const std::filesystem::path& path, const VolumeOnDemand<Label>& volume);
/// Three values a voxel.  NIfTI: I x J x K x 1 x 3 with the intent code of vectors (1007), so that
/// nibabel's `data[i, j, k, 0]` is the vector and viewers show three volumes; MGH: I x J x K x 3;
/// NRRD and MetaImage: three components.
void writeVolume(const std::filesystem::path& path, const Volume<Eigen::Vector3f>& volume);
void writeVolume(const std::filesystem::path& path, const VectorsOnDemand& volume);

/// Writes volumes of equal grids as the frames of one file, I x J x K x T: NIfTI or MGH.
/// @throws InvalidInput  no frame, sizes that differ, another format, and as writeVolume()
void writeFrames(const std::filesystem::path& path,
                 const std::vector<VolumeOnDemand<float>>& frames);

}  // namespace explica::io
