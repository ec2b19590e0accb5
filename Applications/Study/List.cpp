// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Study/StudyState.h"
#include "StudyInput.h"

#include <filesystem>
#include <iostream>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct StudyListSettings {
  std::string study;
  std::optional<std::string> out;
  bool todo = false;
  bool keys = false;
};

void declare(Declaration& d, StudyListSettings& s) {
  d.synopsis("the subjects of a study, one a line, for schedulers")
      .description(
          "With --todo only those whose work is not settled: OUT_DIR/state holds no file of theirs "
          "with the present key. The key is a hash of the options, the content of the inputs and "
          "the software's version; neither dates nor the number of threads are part of it. With "
          "--keys each label is followed by a tab and the key.")
      .example("explica study list study.yaml results --todo", "What is left to do")
      .input("STUDY", FileKind::Any, "study file, YAML or JSON", s.study)
      .argument(Field{"OUT_DIR", "", "folder of the results; only for --todo"}, s.out)
      .category("List")
      .option("todo", "only subjects whose work is not settled", s.todo)
      .option("keys", "the key of each subject, too", s.keys)
      .withoutOutput();
  d.find("OUT_DIR")->required = false;
}

Termination run(Context&, const StudyListSettings& s) {
  if (s.todo && !s.out) {
    throw UsageError("--todo needs OUT_DIR, the folder of the results, after the study file");
  }
  const study::StudyFile file = readCheckedStudy(s.study);
  if (!s.todo && !s.keys) {
    for (const std::string& label : study::subjectsOf(file)) std::cout << label << "\n";
    return Termination::NotRun;
  }
  const study::PathOptions paths = studyPathOptions();
  for (const study::PlannedSubject& subject : study::planStudy(file, paths).subjects) {
    const std::string key = study::keyOf(subject, paths);
    if (s.todo && isThere(study::stateFile(*s.out, subject, key))) continue;
    std::cout << subject.participant.name().substr(4);
    if (s.keys) std::cout << "\t" << key;
    std::cout << "\n";
  }
  return Termination::NotRun;
}

}  // namespace

Command studyListCommand() {
  return makeCommand<StudyListSettings>("study list", declare, run);
}

}  // namespace explica::app
