// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Execute.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Pipeline/Plan.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Study/BidsDataset.h"
#include "Explica/Study/Derivatives.h"
#include "Explica/Study/StudyTable.h"

#include <array>
#include <filesystem>

namespace explica::app {

enum class BidsLevel { Participant, Group };

}  // namespace explica::app

template <>
struct explica::EnumNames<explica::app::BidsLevel> {
  static constexpr std::array table{std::pair{app::BidsLevel::Participant, "participant"},
                                    std::pair{app::BidsLevel::Group, "group"}};
};

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

struct Settings {
  std::string dataset;
  std::string out;
  BidsLevel level = BidsLevel::Participant;
  std::vector<std::string> participants;
  std::vector<pipeline::RunHemisphere> hemispheres = {pipeline::RunHemisphere::Left,
                                                      pipeline::RunHemisphere::Right};
  bool skipValidator = true;
  bool reuse = true;
  Invocation run;  ///< whose options are taken over
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("a BIDS data set, participant by participant, to a derivative and a study table")
      .description(
          "participant: takes each participant's segmentation, FreeSurfer subject or "
          "skull-stripped "
          "T1 through `explica run`, a hemisphere at a time, into OUT_DIR/runs, and copies the "
          "results "
          "to BIDS names with sidecars. Steps whose inputs and options have not changed, by "
          "content, "
          "are kept. A participant that fails does not stop the others. group: writes study.tsv "
          "and "
          "index.html from all runs, failed ones too.")
      .example("explica bids data derivatives/explica participant --participant-label 01 02",
               "Two participants")
      .example("explica bids data derivatives/explica group", "The table of all")
      .input("BIDS_DIR", FileKind::Folder, "data set or derivative with dataset_description.json",
             s.dataset)
      .argument(Field{"OUT_DIR", "", "folder of the derivative data set"}, s.out)
      .argument(Field{"LEVEL", "", "participant or group"}, s.level)
      .option("Study", Field{"participant-label", "", "participants to do, with or without sub-"},
              s.participants)
      .severalWords("participant-label")
      .option("Study", Field{"hemispheres", "", "hemispheres to do"}, s.hemispheres)
      .option("Study", Field{"skip-bids-validator", "", "accepted; no validator is run"},
              s.skipValidator)
      .defaultOut(s.out)
      .reuseOutputIf(s.reuse)
      .inPlace()
      .output("dataset_description.json", FileKind::JsonFile, "what this derivative is")
      .output("descriptions.tsv", FileKind::Table, "what each desc- means")
      .output(".bidsignore", FileKind::Any, "files that BIDS does not know yet")
      .output("sub-*", FileKind::Folder, "results by BIDS names")
      .output("runs", FileKind::Folder, "the runs themselves, with records and reports")
      .varyingOutput("study.tsv", FileKind::Table, "one row a participant and hemisphere")
      .varyingOutput("index.html", FileKind::Report, "the same, to sort and click");
  if (const Command* command = findCommand("run")) {
    s.run = command->begin();
    d.include(s.run.declaration, "");
    for (const char* ours : {"atlas", "hemisphere", "resume", "kind"}) d.without(ours);
  }
}

/// The options of `explica run` that the user gave here.
Json givenOptions(const Context& context, const Settings& s) {
  Json values = Json::object();
  for (const Parameter& parameter : s.run.declaration.parameters) {
    if (!parameter.positional && context.given(parameter.option.name)) {
      values[parameter.option.name] = provenance::valueOf(parameter.option);
    }
  }
  return values;
}

/// Takes one hemisphere through the run and names its results.
/// @return false if it failed: the reason is then in problem.txt beside the run
bool doHemisphere(Context& context, const Settings& s, const study::Participant& participant,
                  pipeline::RunHemisphere side, Termination& worst) {
  const std::string hemisphere(nameOf(side));
  const std::string name = participant.name() + "_hemi-" + hemisphere;
  const fs::path folder = context.outputFolder() / "runs" / name;
  const fs::path problem = folder / "problem.txt";
  bool good = false;
  try {
    if (!participant.problem.empty()) throw InvalidInput(participant.problem);
    Json values = givenOptions(context, s);
    values["INPUT"] = participant.input.string();
    if (participant.atlas) values["atlas"] = participant.atlas->string();
    values["hemisphere"] = hemisphere;
    values["resume"] = true;
    const Outcome outcome = context.runCommand(*findCommand("run"), "runs/" + name, values);
    if (!reachedGoal(outcome.termination)) worst = outcome.termination;
    fs::remove(problem);
    good = true;
  } catch (const Error& fault) {
    context.warn(name + ": " + fault.what());
    fs::create_directories(folder);
    writeTextFile(problem, std::string(fault.what()) + "\n");
  }
  study::exportRun(folder, context.outputFolder(), participant, hemisphere);
  return good;
}

Termination doParticipants(Context& context, const Settings& s) {
  const auto participants = study::findParticipants(s.dataset, s.participants);
  study::describeDerivatives(context.outputFolder(), s.dataset, provenance::software().version);
  Termination worst = Termination::NotRun;
  int done = 0, failed = 0;
  for (const study::Participant& participant : participants) {
    for (const pipeline::RunHemisphere side : s.hemispheres) {
      if (context.monitor().shouldStop()) {
        worst = Termination::Interrupted;
        break;
      }
      (doHemisphere(context, s, participant, side, worst) ? done : failed) += 1;
    }
  }
  context.result("hemispheres_done", done);
  context.result("hemispheres_failed", failed);
  if (done == 0 && failed > 0) {
    throw InvalidInput(s.dataset + ": all " + std::to_string(failed) +
                       " hemispheres failed; each run's problem.txt says why");
  }
  return worst;
}

Termination doGroup(Context& context) {
  const fs::path out = context.outputFolder();
  const auto rows = study::collectRows(out);
  writeTextFile(out / "study.tsv", study::tableText(rows));
  writeTextFile(out / "index.html", study::indexPage(rows, "Explica study"));
  context.result("rows", rows.size());
  return Termination::NotRun;
}

Termination run(Context& context, const Settings& s) {
  return s.level == BidsLevel::Participant ? doParticipants(context, s) : doGroup(context);
}

}  // namespace

Command bidsCommand() {
  return makeCommand<Settings>("bids", declare, run);
}

}  // namespace explica::app
