// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <fstream>

namespace explica::test {

/// Writes FreeSurfer's label format: the vertices where the key is not 0, with their positions.
inline void writeFreeSurferLabel(const std::filesystem::path& path, const io::LabelMap& labels,
                                 const Positions& positions) {
  std::ofstream file(path);
  file.precision(9);
  file << "#!ascii label, coordinates in scanner RAS\n" << (labels.keys.array() != 0).count();
  for (Eigen::Index v = 0; v < labels.keys.size(); ++v) {
    if (labels.keys[v] != 0) file << '\n' << v << "  " << positions.row(v) << " 0";
  }
  file << '\n';
}

}  // namespace explica::test
