// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Execute.h"
#include "Explica/Application/ManyRuns.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Study/StudyState.h"
#include "KeptRun.h"
#include "StudyInput.h"

#include <algorithm>
#include <filesystem>
#include <new>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

struct StudyParticipantSettings {
  std::string study;
  std::string out;
  std::vector<std::string> participants;
  Keep keep = Keep::All;
};

void declare(Declaration& d, StudyParticipantSettings& s) {
  d.synopsis("the runs of a study's subjects")
      .description(
          "Takes each subject's hemispheres and regions through `explica run` into "
          "OUT_DIR/runs/sub-..., and writes OUT_DIR/state/sub-...-KEY.json once all of a subject's "
          "runs have ended by themselves. Steps whose inputs and options have not changed, by "
          "content, are kept. A run that fails does not stop the others; its problem.txt says why. "
          "Several of these commands may work on one OUT_DIR at a time, on different subjects. "
          "SIGUSR1 or SIGTERM ends it with what was reached: exit code 3, and to be done again. "
          "Exit code 3, too, if some runs failed or have implausible numbers, and 2 if all failed.")
      .example("explica study participant study.yaml results --participant-label 01 02",
               "Two subjects")
      .input("STUDY", FileKind::Any, "study file, YAML or JSON", s.study)
      .argument(Field{"OUT_DIR", "", "folder of the results"}, s.out)
      .category("Study")
      .option("participant-label", "subjects to do, with or without sub-", s.participants)
      .severalWords("participant-label")
      .option(keepField(), s.keep)
      .withoutOutput();
}

/// How the runs so far ended.
struct Account {
  std::size_t runs = 0;
  std::vector<std::string> failed;
  std::string environmentFault;  ///< the machine's fault, which the next run would meet too
  Termination worst = Termination::NotRun;
};

/// A termination that says nothing about the work: the same command would go on.
bool endedFromOutside(Termination termination) {
  return termination == Termination::Interrupted || termination == Termination::MaxTime;
}

/// @return true if the run ended by itself
bool doRun(Context& context, const fs::path& folder, const study::Participant& participant,
           const study::PlannedRun& run, Account& account) {
  const fs::path problem = folder / "problem.txt";
  const bool dry = context.given("dry-run");
  const auto fail = [&](const std::string& why) {
    account.failed.push_back(run.folder);
    sayProblem(context, run.folder, folder, why);
    return false;
  };
  ++account.runs;
  if (!dry) {  // what a killed process leaves: it cannot say so itself
    fs::create_directories(folder);
    writeTextFile(problem,
                  "ended from outside (killed, out of memory or time), or still running\n");
  }
  try {
    if (!participant.problem.empty()) throw InvalidInput(participant.problem);
    Json values = run.values;
    values["INPUT"] = participant.input.string();
    if (participant.atlas) values["atlas"] = participant.atlas->string();
    values["hemisphere"] = run.hemisphere;
    values["resume"] = true;
    const Outcome outcome = context.runApart(*findCommand("run"), folder, values);
    if (dry) return true;
    outcome.abandoned ? sayInterrupted(folder) : static_cast<void>(fs::remove(problem));
    if (!reachedGoal(outcome.termination)) account.worst = outcome.termination;
    if (!outcome.plausible) passFlagsOn(context, "run", folder);
    return !endedFromOutside(outcome.termination);
  } catch (const EnvironmentError& fault) {
    account.environmentFault = fault.what();
    return fail(fault.what());
  } catch (const Error& fault) {
    return fail(fault.what());
  } catch (const std::bad_alloc&) {
    account.environmentFault = "out of memory";
    return fail("out of memory");
  }
}

fs::path folderOf(const StudyParticipantSettings& s, const study::PlannedRun& run) {
  return fs::path(s.out) / "runs" / run.folder;
}

/// What was kept of a subject is what doing it again would give.
bool allKept(const StudyParticipantSettings& s, const study::PlannedSubject& subject,
             const std::string& key) {
  return std::all_of(subject.runs.begin(), subject.runs.end(),
                     [&](const study::PlannedRun& run) { return isKept(folderOf(s, run), key); });
}

Termination run(Context& context, const StudyParticipantSettings& s) {
  const StopScope kept(nullptr);  // what is reached is written
  const bool dry = context.given("dry-run");
  const study::StudyFile file = readCheckedStudy(s.study);
  const study::PathOptions paths = studyPathOptions();
  const study::Study study = study::planStudy(file, paths, s.participants);
  Account account;
  for (const study::PlannedSubject& subject : study.subjects) {
    const std::string key = study::keyOf(subject, paths);
    if (s.keep == Keep::Group && allKept(s, subject, key)) {
      account.runs += subject.runs.size();
      continue;
    }
    if (!dry) study::unsettle(s.out, subject);
    bool settled = true;
    std::map<std::string, fs::path> first;  // a hemisphere's first run, whose steps others share
    for (const study::PlannedRun& run : subject.runs) {
      if (context.monitor().shouldStop()) {
        account.worst = Termination::Interrupted;
        settled = false;
        break;
      }
      const fs::path folder = folderOf(s, run);
      if (!dry && !first.empty()) {
        const auto same = first.find(run.hemisphere);
        shareSteps((same != first.end() ? same : first.begin())->second, folder,
                   same != first.end());
      }
      settled = doRun(context, folder, subject.participant, run, account) && settled;
      first.emplace(run.hemisphere, folder);
    }
    if (!settled || dry) continue;
    if (s.keep == Keep::Group) {
      for (const study::PlannedRun& run : subject.runs) keepForGroup(folderOf(s, run), key);
    }
    study::settle(s.out, subject, key);
  }
  if (!account.environmentFault.empty()) throw EnvironmentError(account.environmentFault);
  if (account.failed.empty()) return account.worst;
  const std::string said = std::to_string(account.failed.size()) + " of " +
                           std::to_string(account.runs) + " runs failed (" +
                           joined(account.failed) + "), as said above" +
                           (dry ? "" : " and in each " + s.out + "/runs/sub-*/problem.txt");
  if (account.failed.size() == account.runs) throw InvalidInput(s.study + ": " + said);
  context.warn(said);
  return !reachedGoal(account.worst) ? account.worst : Termination::Stalled;
}

}  // namespace

Command studyParticipantCommand() {
  return makeCommand<StudyParticipantSettings>("study participant", declare, run);
}

}  // namespace explica::app
