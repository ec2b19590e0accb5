// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::io {

/// The vertices of one hemisphere that a CIFTI file holds.
struct CiftiStructure {
  std::string structure;               ///< CortexLeft or CortexRight
  Eigen::Index vertexCount = 0;        ///< of the whole surface
  std::vector<std::int32_t> vertices;  ///< that are in, ascending: all but the medial wall
};

/// Maps of one hemisphere, of all its vertices; those that are not in are left out.
struct CiftiPart {
  CiftiStructure where;
  std::vector<VertexMap> maps;
};

/// Labels of one hemisphere.
struct CiftiLabels {
  CiftiStructure where;
  LabelMap labels;
};

/// All vertices where `in` is not 0 and known; the medial wall is where it is 0.
[[nodiscard]] CiftiStructure ciftiStructure(const std::string& structure,
                                            const Eigen::VectorXd& in);

/// A file that is made and checked, but not written.
struct CiftiFile {
  const char* ending;              ///< that its name must have
  std::vector<std::uint8_t> head;  ///< header and XML
  std::vector<float> values;       ///< vertices x maps, the maps of a vertex together

  /// @throws InvalidInput      a name with another ending
  /// @throws EnvironmentError  the file cannot be written
  void write(const std::filesystem::path& path) const;
};

/// Maps of one or both hemispheres as CIFTI-2 `.dscalar.nii`: float32, NaN stays.
/// @throws InvalidInput  parts with other maps or lengths, a hemisphere twice, or no vertex
[[nodiscard]] CiftiFile ciftiScalars(const std::vector<CiftiPart>& parts);

/// As above, maps as the frames of a series, `.dtseries.nii`.
/// @param secondsApart  from frame to frame, > 0
[[nodiscard]] CiftiFile ciftiSeries(const std::vector<CiftiPart>& parts, double secondsApart);

/// As above, labels with their names and colours, `.dlabel.nii`.  Entries of equal key in both
/// hemispheres must have one name.
[[nodiscard]] CiftiFile ciftiLabels(const std::vector<CiftiLabels>& parts);

}  // namespace explica::io
