// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/BidsDataset.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <map>

namespace explica::study {
namespace {

namespace fs = std::filesystem;

bool endsWith(const std::string& text, std::string_view ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

/// Folders whose names start with `prefix`, by name.
std::vector<fs::path> foldersOf(const fs::path& parent, std::string_view prefix) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(parent)) {
    if (entry.is_directory() && entry.path().filename().string().rfind(prefix, 0) == 0) {
      folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

/// The first file, by name, that ends so; files in a standard space are left aside.
std::optional<fs::path> firstEndingIn(const fs::path& folder, std::string_view ending) {
  if (!fs::is_directory(folder)) return std::nullopt;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (endsWith(name, ending) && name.find("_space-") == std::string::npos) {
      found.push_back(entry.path());
    }
  }
  if (found.empty()) return std::nullopt;
  return *std::min_element(found.begin(), found.end());
}

/// Labels in the space of a T1: `*_atlas-NAME_dseg.nii.gz`.
std::optional<fs::path> atlasIn(const fs::path& folder) {
  std::optional<fs::path> best;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.find("_atlas-") == std::string::npos || !endsWith(name, "_dseg.nii.gz")) continue;
    if (!best || entry.path() < *best) best = entry.path();
  }
  return best;
}

Participant participantIn(const fs::path& dataset, const fs::path& folder,
                          Participant participant) {
  const fs::path anat = folder / "anat";
  for (const char* ending : {"_desc-aparcaseg_dseg.nii.gz", "_desc-aseg_dseg.nii.gz"}) {
    if (const auto labels = firstEndingIn(anat, ending)) {
      participant.input = *labels;
      return participant;
    }
  }
  const fs::path freeSurfer = dataset / "sourcedata" / "freesurfer" / ("sub-" + participant.label);
  if (fs::exists(freeSurfer / "mri" / "ribbon.mgz")) {
    participant.input = freeSurfer;
    return participant;
  }
  if (const auto brain = firstEndingIn(anat, "_desc-brain_T1w.nii.gz")) {
    participant.input = *brain;
    participant.atlas = atlasIn(anat);
    if (!participant.atlas) {
      participant.problem = brain->string() + ": needs labels in its space beside it, as " +
                            participant.name() + "_atlas-AAL_dseg.nii.gz";
    }
    return participant;
  }
  if (const auto labels = firstEndingIn(anat, "_dseg.nii.gz")) {
    participant.input = *labels;
    return participant;
  }
  participant.problem =
      folder.string() +
      ": holds no segmentation (anat/*_dseg.nii.gz), no sourcedata/freesurfer subject and no "
      "skull-stripped T1 (anat/*_desc-brain_T1w.nii.gz); run fMRIPrep, sMRIPrep or FreeSurfer "
      "first";
  return participant;
}

}  // namespace

std::string Participant::name() const {
  return "sub-" + label + (session ? "_ses-" + *session : "");
}

std::vector<Participant> findParticipants(const fs::path& dataset,
                                          const std::vector<std::string>& labels) {
  if (!fs::is_directory(dataset)) throw InvalidInput(dataset.string() + ": is not a folder");
  if (!fs::exists(dataset / "dataset_description.json")) {
    throw InvalidInput(dataset.string() +
                       ": is not a BIDS data set: dataset_description.json is missing");
  }
  std::vector<Participant> participants;
  for (const fs::path& folder : foldersOf(dataset, "sub-")) {
    Participant participant;
    participant.label = folder.filename().string().substr(4);
    const auto wanted = [&](const std::string& label) {
      return label == participant.label || label == "sub-" + participant.label;
    };
    if (!labels.empty() && std::none_of(labels.begin(), labels.end(), wanted)) continue;
    const std::vector<fs::path> sessions = foldersOf(folder, "ses-");
    if (sessions.empty()) participants.push_back(participantIn(dataset, folder, participant));
    for (const fs::path& session : sessions) {
      participant.session = session.filename().string().substr(4);
      participants.push_back(participantIn(dataset, session, participant));
    }
  }
  for (std::string label : labels) {
    if (label.rfind("sub-", 0) == 0) label = label.substr(4);
    if (std::none_of(participants.begin(), participants.end(),
                     [&](const Participant& p) { return p.label == label; })) {
      throw InvalidInput(dataset.string() + ": has no participant sub-" + label);
    }
  }
  if (participants.empty()) throw InvalidInput(dataset.string() + ": holds no folder sub-*");
  return participants;
}

}  // namespace explica::study
