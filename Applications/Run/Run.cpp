// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Ending.h"
#include "Settings.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/CortexTemplate.h"
#include "Explica/Application/Execute.h"
#include "Explica/Application/ManyRuns.h"
#include "Explica/Application/Plausible.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Pipeline/Asymmetry.h"
#include "Explica/Pipeline/FolderReport.h"
#include "Explica/Pipeline/Plan.h"
#include "Explica/Pipeline/RunState.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Report/Page.h"
#include "Explica/Study/Derivatives.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <filesystem>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What the plan says, and on top what the user set with the step's prefix.
Json valuesOf(const Context& context, const RunSettings& s, const pipeline::PlannedStep& step) {
  Json values = *step.values;
  for (const Invocation& invocation : s.steps) {
    if (invocation.declaration.name != step.command) continue;
    for (const Parameter& parameter : invocation.declaration.parameters) {
      if (parameter.option.name == "accept" && !s.accept.empty()) values["accept"] = s.accept;
      if (parameter.positional || !context.given(step.command + "." + parameter.option.name))
        continue;
      values[parameter.option.name] = provenance::valueOf(parameter.option);
    }
  }
  return values;
}

/// Warns of what is said to a step that --steps leaves out, as the file of a study may.
void warnOfIdleOptions(const Context& context, const RunSettings& s, const pipeline::Plan& plan) {
  if (s.plan.steps.empty()) return;
  for (const Invocation& invocation : s.steps) {
    const std::string& name = invocation.declaration.name;
    if (std::any_of(plan.steps.begin(), plan.steps.end(),
                    [&](const auto& step) { return step.command == name; })) {
      continue;
    }
    for (const Parameter& parameter : invocation.declaration.parameters) {
      const std::string option = name + "." + parameter.option.name;
      if (!context.given(option)) continue;
      context.monitor().warn("--" + option + " has no effect, since --steps leaves " + name +
                             " out");
    }
  }
}

/// The user's choice of a place or viewpoint replaces the plan's.
void settleView(const Context& context, const pipeline::PlannedStep& step, Json& values) {
  const auto given = [&](const char* name) { return context.given("unfold." + std::string(name)); };
  if (given("viewpoint") || given("view-line") || given("view-surface")) values.erase("direction");
  if (given("region") && !given("atlas")) {
    const std::string ending = step.name.substr(step.command.size());
    values["atlas"] =
        (context.outputFolder() / ("parcellate" + ending) / "regions.label.gii").string();
  }
  if (given("center") || given("vertex") || given("label") || given("region")) return;
  Vector direction(-1, 0, 0);
  if (values.contains("direction")) {
    const Json& all = values["direction"];
    const Json& first = all.front().is_array() ? all.front() : all;
    for (int a = 0; a < 3; ++a) direction[a] = first[a];
  }
  const TriangleMesh mesh = io::readSurface((*step.values)["SURFACE"].get<std::string>()).mesh;
  const Point centre = pipeline::outermostPoint(mesh, direction);
  values["center"] = {centre.x(), centre.y(), centre.z()};
}

/// How bright fluid is in the image, as the segmentation has found it, for the surfaces' outer
/// border.
void settleFluid(const Context& context, const pipeline::PlannedStep& step, Json& values) {
  const fs::path found = context.outputFolder() / "segment" / provenance::kSummaryName;
  if (context.given("surface.fluid") || !values.contains("image") ||
      !values.contains("inner-level") ||
      std::find(step.needs.begin(), step.needs.end(), "segment") == step.needs.end() ||
      !isThere(found)) {
    return;
  }
  const Json summary = provenance::readJson(found);
  if (summary.contains("fluid_of_white")) values["fluid"] = summary["fluid_of_white"];
}

/// The surfaces' second image; what has no first one has no use for it.
void settleT2(const RunSettings& s, Json& values) {
  if (!s.t2) return;
  if (!values.contains("image")) {
    throw UsageError("run: --t2 places the outer border beside a T1, and " + s.input +
                     " has surfaces or labels alone");
  }
  values["t2"] = *s.t2;
}

/// The first step that this one needs and that has no outputs.
const std::string* missingNeed(const pipeline::PlannedStep& step,
                               const std::vector<pipeline::StepNote>& notes) {
  using report::StepState;
  for (const std::string& need : step.needs) {
    for (const auto& [name, command, state, message] : notes) {
      if (name == need && state != StepState::Done && state != StepState::StoppedEarly)
        return &need;
    }
  }
  return nullptr;
}

void runStep(Context& context, const RunSettings& s, const pipeline::PlannedStep& step,
             pipeline::StepNote& note, Termination& worst) {
  const Command* command = findCommand(step.command);
  if (command == nullptr)
    throw EnvironmentError("explica " + step.command + " is not part of this build");
  Json values = valuesOf(context, s, step);
  if (step.command == "unfold") settleView(context, step, values);
  if (step.command == "surface") {
    settleFluid(context, step, values);
    settleT2(s, values);
  }
  std::optional<Outcome> outcome;
  if (s.resume) outcome = context.reuseCommand(*command, step.name, values);
  if (outcome) {
    context.info(step.name + ": kept, nothing that it depends on has changed");
  } else {
    outcome = context.runCommand(*command, step.name, values);
  }
  note.state = outcome->exitCode == kDone || reachedGoal(outcome->termination)
                   ? report::StepState::Done
               : context.monitor().shouldStop() ? report::StepState::Interrupted
                                                : report::StepState::StoppedEarly;
  if (outcome->abandoned) context.dropCommand(step.name);  // what an earlier run left
  if (!outcome->plausible) passFlagsOn(context, "step", context.outputFolder() / step.name);
  if (!reachedGoal(outcome->termination)) worst = outcome->termination;
}

/// Left and right beside each other, once both have regions.
void writeAsymmetry(Context& context, const fs::path& out) {
  const fs::path left = out / "surface-L" / "regions.tsv";
  const fs::path right = out / "surface-R" / "regions.tsv";
  if (!isThere(left) || !isThere(right)) return;
  writeTextFile(context.output("asymmetry.tsv"), pipeline::asymmetryTable(left, right));
}

/// The report; what cannot be shown is a warning, what cannot be written ends the run.
void writeReport(Context& context, const fs::path& out) {
  try {
    const report::ReportContent content = pipeline::collectReport(out, {}, context.monitor());
    writeTextFile(context.output("report.html"), report::reportPage(content));
    if (const auto small = pipeline::thumbnailOf(content)) {
      report::writePng(context.output("thumbnail.png"), *small);
    }
  } catch (const EnvironmentError&) {
    throw;
  } catch (const Error& fault) {
    context.warn(std::string("report: ") + fault.what());
  }
}

bool isNamed(const RunSettings& s, pipeline::RunStep step) {
  return std::count(s.plan.steps.begin(), s.plan.steps.end(), step) > 0;
}

/// The template to register to; none where the image has another one than Colin27, or none.
std::string templateOf(Context& context, const RunSettings& s) {
  const bool needed =
      isNamed(s, pipeline::RunStep::Register) || isNamed(s, pipeline::RunStep::Parcellate);
  if (needed && s.plan.cortexTemplate == kNoTemplate) {
    throw UsageError(
        "--template none leaves nothing to register to; leave it out, or the steps "
        "register and parcellate");
  }
  if (needed || context.given("template")) return s.plan.cortexTemplate;
  if (context.given("segment.template")) return kNoTemplate;
  if (hasTemplate(s.plan.cortexTemplate)) return s.plan.cortexTemplate;
  context.info("mricron-data is not installed: hemispheres are not registered to a template");
  return kNoTemplate;
}

/// The plan.  If the input does not allow one, what an earlier run made of another input goes.
pipeline::Plan planOrTakeBack(Context& context, const RunSettings& s) {
  try {
    pipeline::PlanOptions options = s.plan;
    options.cortexTemplate = templateOf(context, s);
    return pipeline::planRun(s.input, context.outputFolder(), s.atlas, options);
  } catch (const Error&) {
    if (s.resume) {
      for (const std::string step : study::kRunSteps) {
        for (const char* ending : {"", "-L", "-R"}) context.dropCommand(step + ending);
      }
    }
    throw;
  }
}

/// What was found in the input and what it is taken for: to the user and into the record.
void sayWhatIsUsed(Context& context, const RunSettings& s, const pipeline::Plan& plan) {
  context.info(s.input + ": taken as " + std::string(nameOf(plan.kind)));
  Json used = Json::object();
  for (const pipeline::SourceFile& source : plan.sources) {
    const std::string meaning = source.meaning.empty() ? "" : " (" + source.meaning + ")";
    context.info(source.role + ": " + context.input(source.path, source.role).string() + meaning);
    used[source.role] = source.path.filename().string() + meaning;
  }
  for (const std::string& remark : plan.remarks) context.info(remark);
  context.note("INPUT",
               Json{{"kind", nameOf(plan.kind)}, {"used", used}, {"remarks", plan.remarks}});
}

/// Says what is used, and refuses what can be refused before the work; in a dry run also what the
/// steps check of files that are there.
void checkBeforehand(Context& context, const RunSettings& s, const pipeline::Plan& plan) {
  context.judged();
  sayWhatIsUsed(context, s, plan);
  if (plan.kind == pipeline::InputKind::Labels) {
    Judge(context, s.accept).require("thick-slices", io::readGrid(s.input).spacing.maxCoeff());
  }
  for (const auto* file : {&s.atlas, &s.t2}) {
    if (*file) static_cast<void>(io::readGrid(**file));
  }
  for (const pipeline::PlannedStep& step : plan.steps) {
    Json values = *step.values;
    if (step.command == "surface") settleT2(s, values);
  }
  if (!context.given("dry-run")) return;
  for (const pipeline::PlannedStep& step : plan.steps) {
    Json values = valuesOf(context, s, step);
    if (step.command == "unfold") {
      if (!isThere(values["SURFACE"].get<std::string>())) continue;
      settleView(context, step, values);
    }
    context.runCommand(*findCommand(step.command), step.name, values);
  }
}

Termination run(Context& context, const RunSettings& s) {
  const StopScope kept(nullptr);  // what is reached is written
  const fs::path out = context.outputFolder();
  const pipeline::Plan whole = planOrTakeBack(context, s);
  const std::vector<pipeline::PlannedStep>& plan = whole.steps;
  warnOfIdleOptions(context, s, whole);
  checkBeforehand(context, s, whole);

  std::vector<pipeline::StepNote> notes;
  for (const auto& step : plan)
    notes.push_back({step.name, step.command, report::StepState::Missing, ""});
  const bool withReport = s.plan.steps.empty() || isNamed(s, pipeline::RunStep::Report);
  const std::string state = context.output(pipeline::kRunStateName).string();
  Termination worst = Termination::NotRun;
  std::exception_ptr failure;
  for (std::size_t n = 0; n < plan.size(); ++n) {
    if (const std::string* missing = missingNeed(plan[n], notes)) {
      notes[n].message = "needs " + *missing;
      continue;
    }
    if (context.monitor().shouldStop()) {
      notes[n].state = report::StepState::Interrupted;
      notes[n].message = "the run was stopped before it";
      worst = Termination::Interrupted;
      continue;
    }
    try {
      runStep(context, s, plan[n], notes[n], worst);
    } catch (const Error& fault) {
      // An earlier run's results of this step are of other inputs or options.
      context.dropCommand(plan[n].name);
      if (!s.resume) {  // a run that cannot be resumed leaves nothing
        for (std::size_t m = 0; m < n; ++m) context.dropCommand(plan[m].name);
        throw;
      }
      // What does not depend on it goes on; the report says what failed, and so does the end.
      notes[n].state = report::StepState::Failed;
      notes[n].message = context.isPrivate() ? provenance::textWithoutFolders(fault.what())
                                             : std::string(fault.what());
      context.warn(plan[n].name + ": " + fault.what());
      if (!failure) failure = std::current_exception();
    }
    if (s.resume) pipeline::writeRunState(state, notes);
  }
  pipeline::writeRunState(state, notes);
  for (const auto& note : notes) {
    const bool done = note.state == report::StepState::Done;
    const bool interrupted = note.state == report::StepState::Interrupted;
    context.result(note.name, done ? "done" : interrupted ? "interrupted" : "stopped early");
  }
  writeAsymmetry(context, out);
  if (withReport) {
    auto step = context.step("report");
    writeReport(context, out);
  }
  if (failure) std::rethrow_exception(failure);
  for (const std::string& line : whatCameOut(out)) context.info(line);
  if (withReport) context.info("report: " + (out / "report.html").string());
  return worst;
}

}  // namespace

Command runCommand() {
  return makeCommand<RunSettings>("run", declareRun, run);
}

}  // namespace explica::app
