// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DoSteps.h"
#include "Ending.h"
#include "Settings.h"
#include "StepValues.h"

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
  checkSides(context, s, plan);
  checkT2(s, plan);
  if (!context.given("dry-run")) return;
  for (const pipeline::PlannedStep& step : plan.steps) {
    const bool isMade = step.command == "unfold" && !isThere((*step.values)["SURFACE"]);
    if (isMade) continue;
    context.runCommand(*findCommand(step.command), step.name, stepValues(context, s, step));
  }
}

Termination run(Context& context, const RunSettings& s) {
  const StopScope kept(nullptr);  // what is reached is written
  const fs::path out = context.outputFolder();
  const pipeline::Plan whole = planOrTakeBack(context, s);
  warnOfIdleOptions(context, s, whole);
  checkBeforehand(context, s, whole);

  const bool withReport = s.plan.steps.empty() || isNamed(s, pipeline::RunStep::Report);
  const auto [notes, worst, failure] = doSteps(context, s, whole.steps);
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
