// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/Study/HeartStudy.h"
#include "Explica/Study/StudyTable.h"
#include "GroupStage.h"
#include "StudyInput.h"

#include <filesystem>
#include <map>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct StudyGroupSettings {
  std::string study;
  std::string out;
  bool reuse = true;
  GroupSettings group;
};

void declare(Declaration& d, StudyGroupSettings& s) {
  d.synopsis("the table of a study and its page")
      .description(
          "Writes a row for every run that the study file asks for, whatever became of it: done, "
          "stopped early, failed and why, not begun. Those whose runs have brought them to a "
          "template are put together there, below OUT_DIR/group; who failed or is doubted is left "
          "out and named, unless the study file (group: include) or --include says otherwise; "
          "outliers are named and stay. The columns of participants.tsv go into every table.")
      .example("explica study group study.yaml results", "results/study.tsv, results/index.html")
      .input("STUDY", FileKind::Any, "study file, YAML or JSON", s.study)
      .argument(Field{"OUT_DIR", "", "folder of the results"}, s.out)
      .defaultOut(s.out)
      .reuseOutputIf(s.reuse)
      .inPlace()
      .varyingOutput("study.tsv", FileKind::Table, "one row a subject, hemisphere and region")
      .varyingOutput("study_regions.tsv", FileKind::Table, "one row a region and measure")
      .varyingOutput("study_internals.tsv", FileKind::Table, "how each step went")
      .varyingOutput("index.html", FileKind::Report, "the same, to sort and click");
  declareGroup(d, s.group);
}

/// What the study file says of the group, where the command line does not.
GroupSettings groupOf(const Context& context, const study::StudyFile& file, GroupSettings group) {
  const provenance::Json said = file.values.value("group", provenance::Json::object());
  if (!context.given("include")) group.include = said.value("include", group.include);
  if (!context.given("model") && said.contains("model")) {
    group.model = said["model"].get<std::string>();
  }
  if (!context.given("fwhm")) group.fwhm = said.value("fwhm", group.fwhm);
  return group;
}

/// participants.tsv of the study's data set, or beside the study file.
AboutPeople aboutOf(const study::StudyFile& file) {
  fs::path dataset = file.values.value("dataset", std::string("."));
  if (dataset.is_relative()) dataset = file.path.parent_path() / dataset;
  return study::aboutParticipants(dataset);
}

/// A row a planned run, in the order of the study file.
std::vector<study::StudyRow> rowsOf(const study::Study& study, const fs::path& out) {
  std::map<std::string, study::StudyRow> made;
  if (isFolder(out / "runs")) {
    for (study::StudyRow& row : study::collectRows(out)) {
      std::string folder = row.participant + "_hemi-" + row.hemisphere;
      if (!row.region.empty()) folder += "_region-" + row.region;
      made.emplace(std::move(folder), std::move(row));
    }
  }
  std::vector<study::StudyRow> rows;
  for (const study::PlannedSubject& subject : study.subjects) {
    for (const study::PlannedRun& run : subject.runs) {
      const auto found = made.find(run.folder);
      study::StudyRow row;
      if (found != made.end()) {
        row = found->second;
      } else {
        row.participant = subject.participant.name();
        row.hemisphere = run.hemisphere;
        row.region = run.region;
        row.state = "not begun";
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

Termination run(Context& context, const StudyGroupSettings& s) {
  const study::StudyFile file = readCheckedStudy(s.study);
  const study::Study study = study::planStudy(file, studyPathOptions());
  const AboutPeople about = aboutOf(file);
  std::vector<study::StudyRow> rows = rowsOf(study, s.out);
  writeStudy(context, groupOf(context, file, s.group), about, rows, study.name);
  std::map<std::string, int> states;
  for (const study::StudyRow& row : rows)
    ++states[row.state.substr(0, row.state.find_first_of(" :("))];
  context.info(joined(
      states, ", ", [](const auto& one) { return std::to_string(one.second) + " " + one.first; }));
  context.result("rows", rows.size());
  for (const auto& [state, count] : states) context.result("runs_" + state, count);
  return Termination::NotRun;
}

}  // namespace

Command studyGroupCommand() {
  return makeCommand<StudyGroupSettings>("study group", declare, run);
}

}  // namespace explica::app
