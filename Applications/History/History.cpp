// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Provenance/Verify.h"

#include <iostream>

namespace explica::app {
namespace {

struct HistorySettings {
  std::string file;
};

void declare(Declaration& d, HistorySettings& s) {
  d.synopsis("how a file came about, step by step, back to the first input")
      .description("Follows the provenance records beside the file and beside its inputs.")
      .example("explica history shell/labels.nii.gz", "Where does this volume come from?")
      .input("FILE", FileKind::Any, "a result, or a provenance.json", s.file)
      .withoutOutput();
}

Termination run(Context&, const HistorySettings& s) {
  std::cout << provenance::historyOf(s.file);
  return Termination::NotRun;
}

}  // namespace

Command historyCommand() {
  return makeCommand<HistorySettings>("history", declare, run);
}

}  // namespace explica::app
