// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Execute.h"
#include "Explica/Application/ManyRuns.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Study/HeartStudy.h"

#include <filesystem>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

struct StudyHeartsSettings {
  std::string dataset;
  std::string out;
  std::vector<std::string> participants;
  std::vector<std::string> endings;
  bool reuse = true;
  Invocation heart;  ///< whose options are taken over
};

void declare(Declaration& d, StudyHeartsSettings& s) {
  d.synopsis("a folder of hearts, person by person, to one table")
      .description(
          "Takes every person's label volumes through `explica heart` into OUT_DIR/PERSON/heart "
          "and writes hearts.tsv, a row a person (and session) with volumes, mass, ejection "
          "fraction, thickness and the 17 segments beside the columns of participants.tsv. A "
          "person is a folder of DATA_DIR, sub-* of BIDS or any other, and its frames are the "
          "files *_dseg.nii.gz, else *_gt.nii.gz (ACDC), else *_label.nii.gz, else *_seg.nii.gz "
          "below it. A heart that fails does not stop the others: its row says why; exit code 3, "
          "or 2 if all failed. Hearts whose inputs and options have not changed, by content, are "
          "kept.")
      .example("explica study hearts acdc hearts", "All patients of ACDC's training set")
      .example("explica study hearts data hearts --participant-label 01 02 --preset mms",
               "Two participants")
      .input("DATA_DIR", FileKind::Folder, "folder with one folder a person", s.dataset)
      .argument(Field{"OUT_DIR", "", "folder of the results"}, s.out)
      .category("Study")
      .option("participant-label", "people to do, with or without sub-", s.participants)
      .severalWords("participant-label")
      .option("endings",
              "endings of the label volumes' names before .nii.gz, in place of _dseg, _gt, "
              "_label, _seg",
              s.endings)
      .defaultOut(s.out)
      .reuseOutputIf(s.reuse)
      .inPlace()
      .shareOfWork([&s] { return shareOfWork(s.participants); })
      .output("dataset_description.json", FileKind::JsonFile, "what this derivative is")
      .output(".bidsignore", FileKind::Any, "files that BIDS does not know")
      .output("*/heart", FileKind::Folder, "what `explica heart` writes of each person")
      .varyingOutput("hearts.tsv", FileKind::Table, "one row a person")
      .varyingOutput("hearts.json", FileKind::JsonFile, "what its columns mean, with units")
      .varyingOutput("index.html", FileKind::Report, "the same with each person's bull's-eyes");
  if (const Command* command = findCommand("heart")) {
    s.heart = command->begin();
    d.include(s.heart.declaration, "");
  }
}

/// @return false if it failed: the reason is then in problem.txt in its folder
bool doHeart(Context& context, const StudyHeartsSettings& s, const study::HeartSubject& subject,
             Termination& worst) {
  const std::string name = (subject.folder / "heart").generic_string();
  const fs::path folder = context.outputFolder() / name;
  try {
    if (subject.labels.empty()) throw InvalidInput("no label volume lies below its folder");
    Json values = givenOptions(context, s.heart.declaration);
    values["SEG"] = Json::array();
    for (const fs::path& file : subject.labels) values["SEG"].push_back(file.string());
    const Command& heart = *findCommand("heart");
    auto outcome = context.reuseCommand(heart, name, values);
    if (!outcome) {
      context.dropCommand(name);
      if (!context.given("dry-run")) fs::remove(folder / "problem.txt");
      outcome = context.runCommand(heart, name, values);
    }
    if (!reachedGoal(outcome->termination)) worst = outcome->termination;
    if (outcome->abandoned) sayInterrupted(folder);
    return true;
  } catch (const EnvironmentError&) {
    throw;  // a full disk, or another run at work here: no fault of the heart
  } catch (const Error& fault) {
    context.dropCommand(name);
    sayProblem(context, subject.name, folder, fault.what());
    return false;
  }
}

void describeDerivative(const fs::path& out) {
  const Json description = {
      {"Name", "Left ventricles measured by Explica"},
      {"BIDSVersion", "1.10.0"},
      {"DatasetType", "derivative"},
      {"GeneratedBy",
       Json::array({{{"Name", "explica"}, {"Version", provenance::software().version}}})}};
  writeTextFile(out / "dataset_description.json", provenance::textOf(description, 2) + "\n");
  writeTextFile(out / ".bidsignore", "*/heart/\n*/*/heart/\nhearts.*\nindex.html\n");
}

void writeTables(Context& context, const StudyHeartsSettings& s, const study::HeartLayout& layout) {
  const auto everybody = study::findHearts(s.dataset, {}, layout);
  const auto rows =
      study::heartRows(context.outputFolder(), everybody, study::aboutParticipants(s.dataset));
  writeTextFile(context.output("hearts.tsv"), study::heartTable(rows));
  writeTextFile(context.output("hearts.json"), study::heartColumns(rows));
  writeTextFile(context.output("index.html"), study::heartPage(rows, "Left ventricles"));
  context.result("rows", rows.size());
}

Termination run(Context& context, const StudyHeartsSettings& s) {
  const StopScope kept(nullptr);  // what is reached is written
  study::HeartLayout layout;
  if (!s.endings.empty()) layout.endings = s.endings;
  const auto subjects = study::findHearts(s.dataset, s.participants, layout);
  (void)study::aboutParticipants(s.dataset);  // its faults are said before the work
  const bool dry = context.given("dry-run");
  if (!dry) describeDerivative(context.outputFolder());
  Termination worst = Termination::NotRun;
  std::vector<std::string> failed;
  for (const study::HeartSubject& subject : subjects) {
    if (context.monitor().shouldStop()) {
      worst = Termination::Interrupted;
      break;
    }
    if (!doHeart(context, s, subject, worst)) failed.push_back(subject.name);
  }
  if (!dry) writeTables(context, s, layout);
  context.result("hearts", subjects.size());
  context.result("hearts_failed", failed.size());
  context.result("failed", Json(failed));
  return endOfRuns(context, s.dataset, "hearts", subjects.size(), failed, worst);
}

}  // namespace

Command studyHeartsCommand() {
  return makeCommand<StudyHeartsSettings>("study hearts", declare, run);
}

}  // namespace explica::app
