// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Verify.h"
#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Export.h"

#include <filesystem>
#include <iostream>

namespace explica::app {
namespace {

struct VerifySettings {
  std::string record;
  bool deep = false;
  bool provJson = false;
};

void declare(Declaration& d, VerifySettings& s) {
  d.synopsis("compare inputs and outputs of a run with the hashes in its record")
      .description(
          R"(Prints one line per file: same, CHANGED or MISSING. Ends with exit code 2 if any file is not as recorded.)")
      .example("explica verify shell/provenance.json", "Is the shell still what was made?")
      .input("PROVENANCE", FileKind::Any, "a provenance.json, or the folder that holds it",
             s.record)
      .category("Verification")
      .option("deep", "follow the records of the inputs, back to the first", s.deep)
      .option("prov-json",
              "print the record as W3C PROV-JSON instead of verifying; with --deep those of "
              "its inputs too",
              s.provJson)
      .withoutOutput();
}

const char* wordFor(provenance::FileState state) {
  switch (state) {
    case provenance::FileState::Same:
    case provenance::FileState::Unhashed:
      return "same   ";
    case provenance::FileState::Changed:
      return "CHANGED";
    case provenance::FileState::Missing:
      return "MISSING";
  }
  return "";
}

Termination run(Context& context, const VerifySettings& s) {
  const std::filesystem::path record = provenance::recordAt(s.record);
  if (s.provJson) {
    using provenance::LocatedRecord;
    const auto records = s.deep
                             ? provenance::recordsBehind(record)
                             : std::vector<LocatedRecord>{{record, provenance::readRecord(record)}};
    std::cout << provenance::textOf(provenance::toProvJson(records), 2) << "\n";
    return Termination::NotRun;
  }
  const auto verification = provenance::verifyRecord(record, s.deep);
  std::size_t wrong = 0;
  for (const auto& file : verification.files) {
    const bool same =
        file.state == provenance::FileState::Same || file.state == provenance::FileState::Unhashed;
    wrong += same ? 0 : 1;
    std::cout << wordFor(file.state) << "  "
              << provenance::printable(file.what + "  " + file.path.string()) << "\n";
  }
  std::cout.flush();
  if (wrong > 0) {
    throw InvalidInput(record.string() + ": " + std::to_string(wrong) + " of " +
                       std::to_string(verification.files.size()) + " files are not as recorded");
  }
  context.info("all " + std::to_string(verification.files.size()) + " files unchanged");
  return Termination::NotRun;
}

}  // namespace

Command verifyCommand() {
  return makeCommand<VerifySettings>("verify", declare, run);
}

}  // namespace explica::app
