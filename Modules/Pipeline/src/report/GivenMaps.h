// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ResultFolder.h"

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

namespace explica::pipeline {

/// Values on vertices that the reader wants to see on whatever surface they fit.
struct GivenMap {
  std::string name;  ///< with its file's where it says too little: "bold depth 0.5"
  std::string unit;
  std::string side;  ///< "left", "right", or empty if not known
  Eigen::VectorXd values;

  /// Whether it may belong to a surface of that many vertices, of that side ("": not known).
  [[nodiscard]] bool fits(Eigen::Index vertexCount, const std::string& ofSide) const;
};

/// What maps of a file are called beside those of other files.
[[nodiscard]] std::string nameBesideOthers(const std::filesystem::path& file,
                                           const std::string& map);

/// Reads the maps of files; one that cannot be read is left out, and the report says so.
[[nodiscard]] std::vector<GivenMap> readGivenMaps(ResultFolder& results,
                                                  const std::vector<std::string>& files);

}  // namespace explica::pipeline
