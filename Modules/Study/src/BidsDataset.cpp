// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/BidsDataset.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Document.h"
#include "Explica/Study/SubjectFiles.h"

#include <algorithm>

namespace explica::study {
namespace {

namespace fs = std::filesystem;

/// Folders whose names start with `prefix`, by name.
std::vector<fs::path> foldersFrom(const fs::path& parent, std::string_view prefix) {
  return foldersOf(parent, [&](const std::string& name) { return name.starts_with(prefix); });
}

/// What a folder offers; empty if nothing, and then `problem` says why.
std::optional<SubjectFiles> lookInto(const fs::path& folder, std::string& problem) {
  try {
    return findSubjectFiles(folder);
  } catch (const Error& fault) {
    problem = fault.what();
    return std::nullopt;
  }
}

/// FreeSurfer's work, in BIDS's names.
bool isFreeSurfers(const SubjectFiles& files) {
  return files.left.white || files.right.white ||
         (files.labels && files.labels->filename().string().find("_desc-a") != std::string::npos);
}

/// FreeSurfer's work on a session, or on the person, if there are not several to tell apart.
fs::path freeSurferOf(const fs::path& dataset, const Participant& participant, bool several) {
  const fs::path subjects = dataset / "sourcedata" / "freesurfer";
  const fs::path own = subjects / participant.name();
  return several || isThere(own) ? own : subjects / ("sub-" + participant.label);
}

Participant participantIn(const fs::path& freeSurfer, const fs::path& folder,
                          Participant participant) {
  std::string whyNotFreeSurfer;
  std::optional<SubjectFiles> made;
  if (isThere(freeSurfer)) made = lookInto(freeSurfer, whyNotFreeSurfer);
  const auto anat = lookInto(folder / "anat", participant.problem);
  if (anat && (!made || isFreeSurfers(*anat))) {
    participant.input = folder / "anat";
  } else if (made) {
    participant.input = freeSurfer;
    participant.problem.clear();
  } else if (!whyNotFreeSurfer.empty()) {
    participant.problem = whyNotFreeSurfer;
  }
  return participant;
}

}  // namespace

std::string Participant::name() const {
  return "sub-" + label + (session ? "_ses-" + *session : "");
}

std::vector<Participant> findParticipants(const fs::path& dataset,
                                          const std::vector<std::string>& labels) {
  if (!isFolder(dataset)) throw InvalidInput(dataset.string() + ": is not a folder");
  const fs::path description = dataset / "dataset_description.json";
  if (!isThere(description)) {
    throw InvalidInput(dataset.string() +
                       ": is not a BIDS data set: dataset_description.json is missing");
  }
  if (!provenance::readJson(description).is_object()) {
    throw InvalidInput(description.string() + ": is no JSON object, such as {\"Name\": \"study\"}");
  }
  std::vector<Participant> participants;
  for (const fs::path& folder : foldersFrom(dataset, "sub-")) {
    Participant participant;
    participant.label = folder.filename().string().substr(4);
    const auto wanted = [&](const std::string& label) {
      return label == participant.label || label == "sub-" + participant.label;
    };
    if (!labels.empty() && std::ranges::none_of(labels, wanted)) continue;
    std::vector<fs::path> sessions = foldersFrom(folder, "ses-");
    // Of function or diffusion alone there is nothing to be measured.  What fMRIPrep made of all
    // sessions' T1s lies above them.
    std::erase_if(sessions, [](const fs::path& session) { return !isFolder(session / "anat"); });
    const auto add = [&](const fs::path& place) {
      const fs::path freeSurfer = freeSurferOf(dataset, participant, sessions.size() > 1);
      participants.push_back(participantIn(freeSurfer, place, participant));
    };
    if (sessions.empty()) add(folder);
    for (const fs::path& session : sessions) {
      participant.session = session.filename().string().substr(4);
      add(session);
    }
  }
  for (std::string label : labels) {
    if (label.starts_with("sub-")) label = label.substr(4);
    if (std::ranges::none_of(participants,
                             [&](const Participant& p) { return p.label == label; })) {
      throw InvalidInput(dataset.string() + ": has no participant sub-" + label);
    }
  }
  if (participants.empty()) throw InvalidInput(dataset.string() + ": holds no folder sub-*");
  return participants;
}

}  // namespace explica::study
