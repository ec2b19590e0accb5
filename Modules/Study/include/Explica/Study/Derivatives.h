// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/BidsDataset.h"

#include <array>
#include <filesystem>
#include <string>

namespace explica::study {

/// The steps of `explica run`, by the names of their folders, in their order.
inline constexpr std::array kRunSteps = {"segment",  "thickness",  "surface", "sphere", "register",
                                         "resample", "parcellate", "regions", "unfold"};

/// Where a derivative's files came from.
struct DerivativeOrigin {
  std::filesystem::path dataset;  ///< the BIDS data set; "bids:raw:" stands for it
  bool withNames = true;          ///< false: folders of this machine are not told
};

/// Writes what makes a folder a BIDS derivative: dataset_description.json, descriptions.tsv,
/// README.md and .bidsignore (the kinds of surfaces and maps that are not yet part of BIDS).
/// Existing equal files stay as they are.
void describeDerivatives(const std::filesystem::path& out, const DerivativeOrigin& origin,
                         const std::string& version);

/// Copies the outputs of one run of a participant's hemisphere to BIDS names below
/// `out/sub-XX[/ses-YY]/anat`, each with a sidecar: Sources (BIDS URIs, found by the steps'
/// records), SpatialReference, Units, Euler number, defects, the file's hash and the activity that
/// made it (as in prov/).  What the run did not write is left out, and taken away if it is there
/// from an earlier run.
/// @param run         folder of `explica run`
/// @param hemisphere  "L" or "R"
/// @return files written, relative to `out`, without sidecars
std::vector<std::filesystem::path> exportRun(const std::filesystem::path& run,
                                             const std::filesystem::path& out,
                                             const Participant& participant,
                                             const std::string& hemisphere,
                                             const DerivativeOrigin& origin);

}  // namespace explica::study
