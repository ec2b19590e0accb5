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
  std::string label;                   ///< without "sub-"
  std::optional<std::string> session;  ///< without "ses-"
  std::filesystem::path input;         ///< label volume, T1, or FreeSurfer subject directory
  std::optional<std::filesystem::path> atlas;  ///< for a T1: labels in its space
  std::string problem;                         ///< why nothing can be done with it; else empty

  /// "sub-01" or "sub-01_ses-02".
  [[nodiscard]] std::string name() const;
};

/// Participants of a BIDS data set or derivative, one entry a session, in the order of their names.
///
/// Taken is, in this order: a segmentation with FreeSurfer's labels (`*_desc-aseg_dseg.nii.gz`,
/// `*_desc-aparcaseg_dseg.nii.gz`, `*_dseg.nii.gz`) in the session's `anat`; a FreeSurfer subject
/// `sourcedata/freesurfer/sub-01`; a skull-stripped T1 (`*_desc-brain_T1w.nii.gz`) with an atlas in
/// its space (`*_atlas-*_dseg.nii.gz`).  A participant with none of them is listed with its
/// problem.
///
/// @param labels  participants wanted, with or without "sub-"; empty: all
/// @throws InvalidInput  no folder, no dataset_description.json, no participant, or one that is
///                       wanted is absent
[[nodiscard]] std::vector<Participant> findParticipants(
    const std::filesystem::path& dataset, const std::vector<std::string>& labels = {});

}  // namespace explica::study
