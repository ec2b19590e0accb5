// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/StudyTable.h"

#include <string>

namespace explica::study {

/// Takes over a run's tables of regions, and makes columns of the first that is not empty.
/// @param fromSurface   regions.tsv of `explica surface`: a row a region
/// @param fromTemplate  regions.tsv of `explica regions`: a row a region and measure
void addRegions(StudyRow& row, const std::string& fromSurface, const std::string& fromTemplate);

}  // namespace explica::study
