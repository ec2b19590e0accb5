// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::study {

/// Surfaces of one hemisphere that another program has made.
struct HemisphereFiles {
  std::optional<std::filesystem::path> white, pial;   ///< both or none: one alone is of no use
  std::optional<std::filesystem::path> mid;           ///< half way between them
  std::optional<std::filesystem::path> parcellation;  ///< labels on their vertices
};

/// How a subject's files lie.
enum class SubjectLayout {
  FreeSurfer,  ///< subject directory of recon-all, FastSurfer: mri, surf, label
  Bids         ///< `sub-XX/[ses-YY/]anat` of fMRIPrep, sMRIPrep or a data set of segmentations
};

/// What there is of a subject to start from.
struct SubjectFiles {
  SubjectLayout layout = SubjectLayout::Bids;
  std::optional<std::filesystem::path> labels;         ///< white and grey matter, voxel by voxel
  std::optional<std::filesystem::path> image;          ///< the brain whose labels these are
  std::optional<std::filesystem::path> t1;             ///< in which an atlas lies
  std::optional<std::filesystem::path> mask;           ///< brain, if the T1 still has its skull
  std::optional<std::filesystem::path> atlas;          ///< cortical regions, voxel by voxel
  std::optional<std::filesystem::path> surfaceVolume;  ///< whose surface RAS the surfaces use
  HemisphereFiles left, right;
  std::vector<std::string> remarks;  ///< what was expected and is not there, and what follows

  [[nodiscard]] const HemisphereFiles& of(const std::string& hemisphere) const {
    return hemisphere == "R" ? right : left;
  }
};

/// Looks through a subject's folder: a FreeSurfer subject directory, a `sub-XX`, `ses-YY` or `anat`
/// folder of a BIDS data set or derivative.
///
/// FreeSurfer: labels are `mri/ribbon.mgz`, else `mri/aseg.mgz`; their image `mri/brain.mgz`, else
/// `mri/norm.mgz`; atlas `mri/aparc+aseg.mgz`;
/// surfaces `surf/?h.white` and `surf/?h.pial` with `label/?h.aparc.annot`.
/// BIDS, in this order: `*_desc-aseg_dseg`, `*_desc-aparcaseg_dseg`; a skull-stripped T1
/// (`*_desc-brain_T1w`, or `*_desc-preproc_T1w` with `*_desc-brain_mask`) with an atlas in its
/// space (`*_atlas-*_dseg`); any other `*_dseg`.  Surfaces are `*_hemi-L_white.surf.gii` (or
/// `smoothwm`) and `*_hemi-L_pial.surf.gii`.  Files in a standard space (`_space-`) are left aside.
///
/// @throws InvalidInput  no such folder, or nothing in it to start from: says what was looked for
[[nodiscard]] SubjectFiles findSubjectFiles(const std::filesystem::path& folder);

}  // namespace explica::study
