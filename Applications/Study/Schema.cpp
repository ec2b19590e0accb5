// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "StudyInput.h"

#include <iostream>

namespace explica::app {
namespace {

struct StudySchemaSettings {};

void declare(Declaration& d, StudySchemaSettings&) {
  d.synopsis("the JSON schema of study files, for editors and other programs")
      .description(
          "Generated from the declarations of `explica run`, so that a study file may hold exactly "
          "the options that the command takes.")
      .example("explica study schema", "Prints the schema")
      .withoutOutput();
}

Termination run(Context&, const StudySchemaSettings&) {
  std::cout << provenance::textOf(studyFileSchema(), 2) << "\n";
  return Termination::NotRun;
}

}  // namespace

Command studySchemaCommand() {
  return makeCommand<StudySchemaSettings>("study schema", declare, run);
}

}  // namespace explica::app
