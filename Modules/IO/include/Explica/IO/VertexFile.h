// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace explica::io {

/// What a file holds for each vertex.
enum class VertexFileKind { Maps, Labels, Surface };

/// By the name where it tells (.surf.gii, .label.gii, .annot, .label), else by the content.
/// @throws IOError  it cannot be read as maps nor as a surface
[[nodiscard]] VertexFileKind vertexFileKind(const std::filesystem::path& path);

/// True if a file's name is that of labels: .label.gii, .annot, .label, packed or not.
[[nodiscard]] bool namesLabels(const std::filesystem::path& path);

/// A number a vertex: of a file of labels their keys, else its first map.
/// @throws IOError, InvalidInput  neither, or of another number of vertices
[[nodiscard]] Eigen::VectorXd readVertexNumbers(const std::filesystem::path& path,
                                                Eigen::Index vertexCount);

/// Name of a result made of a file, with what it is put in, in front of a BIDS name's suffix or
/// after any other name, and in the file's kind: "lh.thickness" with "fwhm-5" is
/// "lh.thickness_fwhm-5", "sub-01_hemi-L_thickness.shape.gii" is
/// "sub-01_hemi-L_fwhm-5_thickness.shape.gii".  Maps of MGH and VTK files become GIFTI.
[[nodiscard]] std::string nameWithEntity(const std::filesystem::path& path,
                                         std::string_view entity);

/// Writes maps by the name: GIFTI for .gii, NaN stays; else FreeSurfer's curv, of one map.
/// @throws InvalidInput  several maps for a curv file
void writeVertexMaps(const std::filesystem::path& path, const std::vector<VertexMap>& maps,
                     const std::string& structure, Eigen::Index faceCount);

}  // namespace explica::io
