// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ResultFolder.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace explica::pipeline {

/// The thickness of others, to lie behind a person's.
struct ThicknessReference {
  std::string name;
  Eigen::VectorXd values;  ///< mm, > 0, of all vertices of all of them
};

/// @throws InvalidInput  a folder that does not exist or in which there is no thickness at all
void requireThickness(const std::vector<std::string>& folders);

/// Of the folders that a reader names: results of `explica surface` in them, down to those of a
/// study's runs, and FreeSurfer's own thickness of a subject.  Without such folders FreeSurfer's
/// thickness of the same subject, where a surface was made from its labels.
/// @return none where there is nothing of that side
/// @throws as requireThickness()
[[nodiscard]] std::optional<ThicknessReference> thicknessReference(
    const std::vector<std::string>& folders, const StepFolder& step);

}  // namespace explica::pipeline
