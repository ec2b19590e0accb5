// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::study {

/// What a participant offers to start from.
struct Participant {
  std::string label;                           ///< without "sub-"
  std::optional<std::string> session;          ///< without "ses-"
  std::filesystem::path input;                 ///< anat folder or FreeSurfer subject directory
  std::optional<std::filesystem::path> atlas;  ///< labels to use instead of those found there
  std::string problem;                         ///< why nothing can be done with it; else empty

  /// "sub-01" or "sub-01_ses-02".
  [[nodiscard]] std::string name() const;
};

/// Participants of a BIDS data set or derivative, one entry a session, in the order of their names.
///
/// A participant's input is its `anat` folder, or `sourcedata/freesurfer/sub-01` where that folder
/// holds neither surfaces nor FreeSurfer's segmentation (see findSubjectFiles).  A participant with
/// nothing to start from is listed with its problem; sessions without `anat` beside others with it
/// are not.
///
/// @param labels  participants wanted, with or without "sub-"; empty: all
/// @throws InvalidInput  no folder, no dataset_description.json, no participant, or one that is
///                       wanted is absent
[[nodiscard]] std::vector<Participant> findParticipants(
    const std::filesystem::path& dataset, const std::vector<std::string>& labels = {});

}  // namespace explica::study
