// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/Pipeline/Plan.h"
#include "StudyInput.h"

namespace explica::app {
namespace {

struct StudyCheckSettings {
  std::string study;
};

void declare(Declaration& d, StudyCheckSettings& s) {
  d.synopsis("whether a study file can be run")
      .description(
          "Checks the file against the schema and each subject's input, matrix and regions, and "
          "says in one sentence what is wrong, where, and what helps. Writes nothing.")
      .example("explica study check study.yaml", "Before anything is run")
      .input("STUDY", FileKind::Any, "study file, YAML or JSON", s.study)
      .withoutOutput();
}

/// Why a subject's runs would be refused at once; empty if they would not.
std::string problemOf(const study::PlannedSubject& subject) {
  const study::Participant& participant = subject.participant;
  if (!participant.problem.empty() || subject.runs.empty()) return participant.problem;
  std::optional<std::string> atlas;
  if (participant.atlas) atlas = participant.atlas->string();
  pipeline::PlanOptions options;
  const auto& values = subject.runs.front().values;
  try {
    if (values.contains("kind")) {
      options.kind = valueOf<pipeline::InputKind>(values["kind"].get<std::string>());
    }
    static_cast<void>(pipeline::planRun(participant.input, {}, atlas, options));
  } catch (const Error& fault) {
    return participant.name() + ": " + fault.what();
  }
  return {};
}

Termination run(Context& context, const StudyCheckSettings& s) {
  const study::StudyFile file = readCheckedStudy(s.study);
  const study::Study study = study::planStudy(file, studyPathOptions());
  std::size_t runs = 0, problems = 0;
  for (const study::PlannedSubject& subject : study.subjects) {
    runs += subject.runs.size();
    const std::string problem = problemOf(subject);
    if (problem.empty()) continue;
    ++problems;
    context.warn(problem);
  }
  if (problems > 0) {
    throw InvalidInput(s.study + ": " + std::to_string(problems) + " of " +
                       std::to_string(study.subjects.size()) +
                       " subjects have no usable input; see above (the others can be run)");
  }
  context.info(s.study + ": " + std::to_string(study.subjects.size()) + " subjects, " +
               std::to_string(runs) + " runs");
  return Termination::NotRun;
}

}  // namespace

Command studyCheckCommand() {
  return makeCommand<StudyCheckSettings>("study check", declare, run);
}

}  // namespace explica::app
