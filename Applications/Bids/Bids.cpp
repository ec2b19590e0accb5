// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Execute.h"
#include "Explica/Application/ManyRuns.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Pipeline/Plan.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Export.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Study/BidsDataset.h"
#include "Explica/Study/Derivatives.h"
#include "Explica/Study/HeartStudy.h"
#include "Explica/Study/StudyPage.h"
#include "Explica/Study/StudyState.h"
#include "Explica/Study/StudyTable.h"
#include "Explica/Study/SubjectFiles.h"
#include "GroupStage.h"
#include "KeptRun.h"
#include "StudyInput.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>

namespace explica::app {

enum class BidsLevel { Participant, Group };
constexpr auto enumWords(BidsLevel) {
  using enum BidsLevel;
  return std::to_array<EnumWord<BidsLevel>>({{Participant, "participant"}, {Group, "group"}});
}

namespace {

namespace fs = std::filesystem;
using provenance::Json;

struct BidsSettings {
  std::string dataset;
  std::string out;
  BidsLevel level = BidsLevel::Participant;
  std::vector<std::string> participants;
  std::vector<pipeline::RunHemisphere> hemispheres = {pipeline::RunHemisphere::Left,
                                                      pipeline::RunHemisphere::Right};
  std::optional<std::string> registrations;  ///< an earlier OUT_DIR
  bool skipValidator = true;
  bool reuse = true;
  GroupSettings group;
  Keep keep = Keep::All;
  Invocation run;  ///< whose options are taken over
};

/// The hemispheres to do, each once.
std::vector<pipeline::RunHemisphere> sidesOf(const BidsSettings& s) {
  using pipeline::RunHemisphere;
  for (const RunHemisphere side : s.hemispheres) {
    if (side == RunHemisphere::Both) return {RunHemisphere::Left, RunHemisphere::Right};
  }
  return s.hemispheres;
}

/// A name for the part of the work that the options ask for; empty for all of it.
std::string shareOf(const BidsSettings& s) {
  if (s.level != BidsLevel::Participant) return {};
  std::vector<std::string> sides;
  for (const auto side : sidesOf(s)) sides.emplace_back(nameOf(side));
  return shareOfWork(s.participants, sides);
}

void declare(Declaration& d, BidsSettings& s) {
  d.synopsis("a BIDS data set, participant by participant, to a derivative and a study table")
      .description(
          R"(participant: takes each participant's segmentation, FreeSurfer subject or T1 (as the scanner gives it) through `explica run`, a hemisphere at a time, into OUT_DIR/runs, and copies the results to BIDS names with sidecars. Of several T1 images the first by name is used, those with a contrast agent last; sessions without anat are left out, and what was made of all sessions counts once. Steps whose inputs and options have not changed, by content, are kept. A participant that fails, or whose numbers are implausible, does not stop the others: exit code 3, or 2 if all failed. group: writes from all runs, failed ones too, study.tsv and index.html, puts the people who are on a template together there, below group/ (who failed or is doubted is left out and named), and exports their records as BIDS-Prov. Several of these commands may work on one OUT_DIR at a time, as in a job array, on different participants.)")
      .example("explica bids data derivatives/explica participant --participant-label 01 02",
               "Two participants")
      .example("explica bids data derivatives/explica group", "The table of all")
      .input("BIDS_DIR", FileKind::Folder, "data set or derivative with dataset_description.json",
             s.dataset)
      .argument(Field{"OUT_DIR", "", "folder of the derivative data set"}, s.out)
      .argument(Field{"LEVEL", "", "participant or group"}, s.level)
      .category("Study")
      .option("participant-label", "participants to do, with or without sub-", s.participants)
      .severalWords("participant-label")
      .inputOption(
          "registrations", FileKind::Folder,
          R"(an earlier OUT_DIR, of the same T1s: each one's template is placed as it was there (runs/*/segment/to_template.h5), where it is; how it fits is checked as ever)",
          s.registrations, "Study")
      .option(keepField(), s.keep)
      .option("skip-bids-validator", "accepted; no validator is run", s.skipValidator)
      .defaultOut(s.out)
      .reuseOutputIf(s.reuse)
      .inPlace()
      .shareOfWork([&s] { return shareOf(s); })
      .output("dataset_description.json", FileKind::JsonFile, "what this derivative is")
      .output("descriptions.tsv", FileKind::Table, "what each desc- means")
      .output("README.md", FileKind::Any, "what is where")
      .output(".bidsignore", FileKind::Any, "kinds of files that BIDS does not know yet")
      .varyingOutput("sub-*.html", FileKind::Report,
                     "leads to the reports on a participant; not with --keep group")
      .output("sub-*", FileKind::Folder, "results by BIDS names")
      .output("runs", FileKind::Folder, "the runs themselves, with records and reports")
      .varyingOutput("study.tsv", FileKind::Table, "one row a participant and hemisphere")
      .varyingOutput("study_regions.tsv", FileKind::Table, "one row a region and measure")
      .varyingOutput("study_internals.tsv", FileKind::Table, "how each step went")
      .varyingOutput("index.html", FileKind::Report, "the same, to sort and click")
      .varyingOutput("prov/prov-explica_*.json", FileKind::JsonFile,
                     "how everything came about, as BIDS-Prov");
  declareGroup(d, s.group);
  if (const Command* command = findCommand("run")) {
    s.run = command->begin();
    d.include(s.run.declaration, "");
    for (const char* ours : {"atlas", "hemisphere", "resume", "kind"}) d.without(ours);
  }
  d.category("Study").option("hemisphere", "hemispheres to do", s.hemispheres);
}

/// Both hemispheres of labels without sides would be the same volume, twice.
void requireSides(const BidsSettings& s, const study::Participant& participant) {
  if (sidesOf(s).size() < 2) return;
  const study::SubjectFiles files = study::findSubjectFiles(participant.input);
  if (!files.labels || files.layout == study::SubjectLayout::FreeSurfer) return;
  if (files.left.white && files.right.white) return;
  if (pipeline::labelsHaveSides(*files.labels)) return;
  throw InvalidInput(
      files.labels->string() +
      ": its labels do not tell left from right; name the hemisphere that it holds (--hemisphere "
      "L), or give a segmentation with FreeSurfer's labels (*_desc-aseg_dseg.nii.gz)");
}

/// How the template was placed in a participant's T1 by an earlier study.
std::optional<fs::path> earlierRegistration(const BidsSettings& s, const std::string& participant) {
  if (!s.registrations) return {};
  for (const char* side : {"_hemi-L", "_hemi-R"}) {
    const fs::path file =
        fs::path(*s.registrations) / "runs" / (participant + side) / "segment/to_template.h5";
    if (isThere(file)) return file;
  }
  return {};
}

enum class Ended { Done, Failed, Interrupted };

/// Takes one hemisphere through the run and names its results.  Why it failed is in problem.txt
/// beside the run.
/// @param toKeep  takes the run's folder and key if only what a group needs shall stay of it
Ended doHemisphere(Context& context, const BidsSettings& s, const study::Participant& participant,
                   pipeline::RunHemisphere side, Termination& worst,
                   std::map<fs::path, std::string>& toKeep) {
  const std::string hemisphere(nameOf(side));
  const std::string name = participant.name() + "_hemi-" + hemisphere;
  const fs::path folder = context.outputFolder() / "runs" / name;
  const fs::path problem = folder / "problem.txt";
  const bool dry = context.given("dry-run");
  Ended ended = Ended::Done;
  try {
    if (!participant.problem.empty()) throw InvalidInput(participant.problem);
    requireSides(s, participant);
    Json values = givenOptions(context, s.run.declaration);
    values["INPUT"] = participant.input.string();
    if (participant.atlas) values["atlas"] = participant.atlas->string();
    if (const auto earlier = earlierRegistration(s, participant.name())) {
      values["segment.template-transform"] = earlier->string();
    }
    values["hemisphere"] = hemisphere;
    values["resume"] = true;
    const std::string key =
        study::keyOf({participant, {{name, hemisphere, "", values}}}, studyPathOptions());
    if (s.keep == Keep::Group && !dry && isKept(folder, key)) return ended;
    const std::string other = hemisphere == "L" ? "R" : "L";
    if (!dry) {
      shareSteps(folder.parent_path() / (participant.name() + "_hemi-" + other), folder, false);
    }
    const Outcome outcome = context.runCommand(*findCommand("run"), "runs/" + name, values);
    if (!reachedGoal(outcome.termination)) worst = outcome.termination;
    if (!outcome.plausible) passFlagsOn(context, "run", folder);
    if (dry) return ended;
    outcome.abandoned ? sayInterrupted(folder) : static_cast<void>(fs::remove(problem));
    if (!reachedGoal(outcome.termination) && context.monitor().shouldStop()) {
      ended = Ended::Interrupted;
    }
    if (s.keep == Keep::Group && ended == Ended::Done) {
      toKeep.emplace(folder, key);
      return ended;
    }
  } catch (const EnvironmentError&) {
    throw;  // a full disk, or another run at work here: no fault of the participant
  } catch (const Error& fault) {
    if (!participant.problem.empty()) dropSteps(context, "runs/" + name);
    context.dropCommand("runs/" + name);  // an earlier run's account of itself
    sayProblem(context, name, folder, fault.what());
    ended = Ended::Failed;
  }
  if (dry) return ended;
  const study::DerivativeOrigin origin{s.dataset, !context.isPrivate()};
  study::exportRun(folder, context.outputFolder(), participant, hemisphere, origin);
  return ended;
}

/// The page that leads to the reports on a participant's runs.
void writePage(Context& context, const study::Participant& participant) {
  const std::string subject = "sub-" + participant.label;
  const auto rows = study::collectRows(context.outputFolder(), subject);
  writeTextFile(context.output(subject + ".html"), study::indexPage(rows, subject));
}

/// Images and masks that options name are one head's; an atlas may be everybody's.
void refuseVolumesOfOneHead(const Context& context, const BidsSettings& s, std::size_t heads) {
  for (const Parameter& parameter : s.run.declaration.parameters) {
    const std::string& name = parameter.option.name;
    const bool isOfHead = parameter.file == FileKind::Volume || name.ends_with("mask");
    if (!isOfHead || !context.given(name)) continue;
    throw UsageError("--" + name + " is a volume of one head, and there are " +
                     std::to_string(heads) +
                     " participants and sessions; do one of them with --participant-label");
  }
}

/// All that can be done is done; exit code 3 if some failed, 2 if all did.
Termination doParticipants(Context& context, const BidsSettings& s) {
  const StopScope kept(nullptr);  // what is reached is written
  const auto participants = study::findParticipants(s.dataset, s.participants);
  if (participants.size() > 1) refuseVolumesOfOneHead(context, s, participants.size());
  if (!context.given("dry-run")) {
    study::describeDerivatives(context.outputFolder(), {s.dataset, !context.isPrivate()},
                               provenance::software().version);
  }
  Termination worst = Termination::NotRun;
  std::size_t done = 0;
  std::vector<std::string> failed, interrupted;
  for (const study::Participant& participant : participants) {
    std::map<fs::path, std::string> toKeep;  // of both hemispheres: they share steps
    for (const pipeline::RunHemisphere side : sidesOf(s)) {
      if (context.monitor().shouldStop()) {
        worst = Termination::Interrupted;
        break;
      }
      const std::string name = participant.name() + "_hemi-" + std::string(nameOf(side));
      const Ended ended = doHemisphere(context, s, participant, side, worst, toKeep);
      done += ended == Ended::Done;
      if (ended == Ended::Failed) failed.push_back(name);
      if (ended == Ended::Interrupted) interrupted.push_back(name);
    }
    if (!context.monitor().shouldStop()) {  // else the other hemisphere still needs them
      for (const auto& [folder, key] : toKeep) keepForGroup(folder, key);
    }
    if (!context.given("dry-run") && s.keep == Keep::All) writePage(context, participant);
  }
  context.result("hemispheres_done", done);
  context.result("hemispheres_failed", failed.size());
  context.result("failed", Json(failed));
  context.result("interrupted", Json(interrupted));
  return endOfRuns(context, s.dataset, "hemispheres", done + failed.size() + interrupted.size(),
                   failed, worst);
}

/// How the study came about, in the words of BIDS-Prov.
void writeExports(Context& context) {
  const fs::path out = context.outputFolder();
  const auto records = provenance::recordsBelow(out / "runs");
  for (const auto& [name, content] : provenance::toBidsProv(records, out)) {
    writeTextFile(context.output("prov/" + name), provenance::textOf(content, 1) + "\n");
  }
}

Termination doGroup(Context& context, const BidsSettings& s) {
  const fs::path out = context.outputFolder();
  auto rows = study::collectRows(out);
  writeStudy(context, s.group, study::aboutParticipants(s.dataset), rows, "Explica study");
  writeExports(context);
  context.result("rows", rows.size());
  return Termination::NotRun;
}

Termination run(Context& context, const BidsSettings& s) {
  return s.level == BidsLevel::Participant ? doParticipants(context, s) : doGroup(context, s);
}

}  // namespace

Command bidsCommand() {
  return makeCommand<BidsSettings>("bids", declare, run);
}

}  // namespace explica::app
