// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Bindings.h"
#include "Options.h"

#include "Explica/Pipeline/Plan.h"
#include "Explica/Study/BidsDataset.h"
#include "Explica/Study/HeartStudy.h"
#include "Explica/Study/StudyTable.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace explica::python {

using namespace py::literals;

void bindStudy(py::module_& parent) {
  py::module_ m = parent.def_submodule("study");
  m.def(
      "find_participants",
      [](const std::filesystem::path& dataset, const std::vector<std::string>& labels) {
        py::list list;
        for (const auto& p : study::findParticipants(dataset, labels)) {
          list.append(
              py::dict("name"_a = p.name(), "label"_a = p.label, "session"_a = p.session,
                       "input"_a = p.input.string(),
                       "atlas"_a = p.atlas ? py::object(py::str(p.atlas->string())) : py::none(),
                       "problem"_a = p.problem));
        }
        return list;
      },
      "dataset"_a, "labels"_a = std::vector<std::string>{},
      "Participants of a BIDS data set (default: all), one entry a session: name, label, session,\n"
      "input to start from, atlas, and problem, empty if there is none.");
  m.def(
      "table",
      [](const std::filesystem::path& out) {
        py::list list;
        for (const auto& row : study::collectRows(out)) {
          list.append(py::dict("participant"_a = row.participant, "hemisphere"_a = row.hemisphere,
                               "region"_a = row.region, "state"_a = row.state,
                               "report"_a = row.report.string(), "values"_a = row.values));
        }
        return list;
      },
      "out"_a,
      "Rows of a study's output folder, one a participant's hemisphere: participant, hemisphere,\n"
      "region, state, report and values, a dictionary of text by column.");
  m.def(
      "hearts",
      [](const std::filesystem::path& dataset, const std::filesystem::path& out,
         const std::vector<std::string>& endings) {
        study::HeartLayout layout;
        if (!endings.empty()) layout.endings = endings;
        const auto subjects = study::findHearts(dataset, {}, layout);
        py::list list;
        for (const auto& row : study::heartRows(out, subjects, study::aboutParticipants(dataset))) {
          list.append(py::dict("name"_a = row.name, "state"_a = row.state, "about"_a = row.about,
                               "values"_a = row.values));
        }
        return list;
      },
      "dataset"_a, "out"_a, "endings"_a = std::vector<std::string>{},
      "Rows of what `explica study hearts` has made of a folder of hearts, one a person: name,\n"
      "state, about (participants.tsv) and values, dictionaries of text by column.");
  defWithOptions<pipeline::PlanOptions>(
      m, "plan",
      [](const std::filesystem::path& input, const std::filesystem::path& out,
         const std::optional<std::string>& atlas, const py::kwargs& keywords) {
        const auto options = optionsOf<pipeline::PlanOptions>(keywords);
        py::list steps;
        for (const auto& step : pipeline::planRun(input, out, atlas, options).steps) {
          steps.append(py::dict("name"_a = step.name, "command"_a = step.command,
                                "needs"_a = step.needs, "values"_a = pythonOf(*step.values)));
        }
        return steps;
      },
      "The commands that `explica run` would do for an input, in their order: name of the step's\n"
      "folder, command, the steps it needs, and its option values.",
      "input"_a, "out"_a, "atlas"_a = py::none());
}

}  // namespace explica::python
