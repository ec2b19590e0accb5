// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "StepValues.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Provenance/Record.h"

#include <algorithm>
#include <filesystem>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

/// What the plan says, and on top what the user set with the step's prefix.
Json givenValues(const Context& context, const RunSettings& s, const pipeline::PlannedStep& step) {
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

}  // namespace

Json stepValues(const Context& context, const RunSettings& s, const pipeline::PlannedStep& step) {
  Json values = givenValues(context, s, step);
  if (step.command == "unfold") settleView(context, step, values);
  if (step.command == "surface") {
    settleFluid(context, step, values);
    settleT2(s, values);
  }
  return values;
}

void checkSides(const Context& context, const RunSettings& s, const pipeline::Plan& plan) {
  const auto& steps = plan.steps;
  const auto segment = std::ranges::find(steps, "segment", &pipeline::PlannedStep::command);
  const bool isNeeded = std::ranges::any_of(steps, [](const pipeline::PlannedStep& step) {
    return step.command == "surface" || step.command == "thickness";
  });
  if (segment == steps.end() || !isNeeded) return;
  const Json values = givenValues(context, s, *segment);
  if (values.value("template", "") != "none" || values.contains("atlas")) return;
  throw UsageError(
      "run: without a head's template nothing tells the hemispheres apart; give --atlas, or leave "
      "out --segment.template none");
}

void checkT2(const RunSettings& s, const pipeline::Plan& plan) {
  for (const pipeline::PlannedStep& step : plan.steps) {
    Json values = *step.values;
    if (step.command == "surface") settleT2(s, values);
  }
}

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

}  // namespace explica::app
