// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/BidsDataset.h"

#include <filesystem>
#include <string>

namespace explica::study {

/// Writes what makes a folder a BIDS derivative: dataset_description.json, descriptions.tsv and
/// .bidsignore (surfaces are not yet part of BIDS).  Existing equal files stay as they are.
void describeDerivatives(const std::filesystem::path& out, const std::filesystem::path& source,
                         const std::string& version);

/// Copies the outputs of one run of a participant's hemisphere to BIDS names below
/// `out/sub-XX[/ses-YY]/anat`, each with a sidecar: Sources, SpatialReference, Units, Euler number,
/// defects.  What the run did not write is left out.
/// @param run         folder of `explica run`
/// @param hemisphere  "L" or "R"
/// @return files written, relative to `out`
std::vector<std::filesystem::path> exportRun(const std::filesystem::path& run,
                                             const std::filesystem::path& out,
                                             const Participant& participant,
                                             const std::string& hemisphere);

}  // namespace explica::study
