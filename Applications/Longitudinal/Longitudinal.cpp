// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Change.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/Execute.h"
#include "Explica/Application/ManyRuns.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/TransformFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Pipeline/Plan.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Registration/HeadTransform.h"
#include "Explica/Registration/Sessions.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct LongitudinalSettings {
  std::vector<std::string> sessions;
  std::optional<std::string> atlas;
  pipeline::RunHemisphere hemisphere = pipeline::RunHemisphere::Both;
  Invocation run;  ///< whose options are taken over
};

void declare(Declaration& d, LongitudinalSettings& s) {
  d.synopsis("change of thickness between sessions of a person, on a template of their own")
      .description(
          "Brings the T1s of one person by rigid registration into a space halfway between them, "
          "without favour for any, and takes their mean through explica run. In that space each "
          "session's own image is segmented within the mean's brain mask, by the mean's place on "
          "the head's template, and has its own surfaces: sessions are interpolated alike and cut "
          "out alike. The thickness of each is given at the vertices of the mean's middle surface "
          "and by its regions, with the change since the first session. Options of explica run and "
          "of its steps are those of all of them.")
      .reference("Reuter, Rosas, Fischl 2010, NeuroImage 53(4):1181-1196")
      .reference("Reuter, Schmansky, Rosas, Fischl 2012, NeuroImage 61(4):1402-1418")
      .example("explica longitudinal ses-1_T1w.nii.gz ses-2_T1w.nii.gz --out sub-01",
               "Two sessions, in the order of time; sub-01/regions-L/regions.tsv has the change of "
               "each region")
      .input("SESSION", FileKind::Volume, "T1s of one person, in the order of time; two at least",
             s.sessions)
      .inPlace()
      .output("template.nii.gz", FileKind::Volume, "mean of the sessions, halfway between them")
      .output("session-*.nii.gz", FileKind::Volume,
              "each session in that space, as bright as the first")
      .output("to_session-*.h5", FileKind::Any,
              "ITK transform from the template's points to a session's")
      .output("atlas.nii.gz", FileKind::LabelVolume, "with --atlas: its labels in that space")
      .output("atlas*.t*", FileKind::Any, "with --atlas: what they are called")
      .output("template", FileKind::Folder, "explica run on the mean")
      .output("session-*", FileKind::Folder, "explica run on each session in that space")
      .output("hemi-*_thickness.shape.gii", FileKind::VertexData,
              "thickness of each session at the template's vertices, mm, and its change since the "
              "first; NaN where one is not known")
      .output("regions*", FileKind::Folder,
              "explica regions of these maps: regions.tsv has each region's change")
      .results<Change>();
  if (const Command* command = findCommand("run")) {
    s.run = command->begin();
    d.include(s.run.declaration, "");
    for (const char* ours :
         {"hemisphere", "resume", "kind", "steps", "given-surfaces", "unfold-surface"}) {
      d.without(ours);
    }
    for (const Parameter& parameter : s.run.declaration.parameters) {
      const std::string& name = parameter.option.name;
      if (parameter.file) d.without(name);  // of an image or a mesh that is made here
      for (const char* step : {"thickness.", "resample.", "unfold."}) {
        if (name.starts_with(step)) d.without(name);
      }
    }
  }
  d.category("Run")
      .option("hemisphere", "which hemisphere to work on", s.hemisphere)
      .inputOption("atlas", FileKind::LabelVolume,
                   "labels in the space of the first session, as AAL's: tell hemispheres apart "
                   "instead of a template's, and are the regions",
                   s.atlas);
}

std::vector<Volume<float>> readSessions(Context& context, const LongitudinalSettings& s) {
  if (s.sessions.size() < 2) {
    throw UsageError("'" + s.sessions.front() +
                     "' is one session; a change is between two or more of the same person");
  }
  std::vector<Volume<float>> sessions;
  for (const std::string& path : s.sessions) {
    sessions.push_back(readBrightness(context, "SESSION", path, {.dimension = 3}));
  }
  return sessions;
}

std::optional<Volume<Label>> readAtlas(Context& context, const LongitudinalSettings& s) {
  if (!s.atlas) return {};
  return readLabels(context, "atlas", *s.atlas, {.dimension = 3});
}

/// The atlas in the common space, with its legend.
void writeAtlas(Context& context, const Volume<Label>& atlas, const std::string& path,
                const Eigen::Isometry3d& toFirst, const Grid& grid) {
  registration::HeadTransform transform;
  transform.affine = Eigen::Affine3d(toFirst.matrix());
  io::writeVolume(context.output("atlas.nii.gz"), registration::pulled(atlas, transform, grid));
  if (const auto legend = io::findLegend(path)) {
    const char* name = legend->extension() == ".tsv" ? "atlas.tsv" : "atlas.nii.txt";
    writeTextFile(context.output(name), fileText(context.input(*legend, "atlas-legend")));
  }
}

/// Largest ratio between two sessions' voxels, edges compared by length.
double voxelRatio(const std::vector<Volume<float>>& sessions) {
  Vector least = Vector::Constant(kInfinity), most = Vector::Zero();
  for (const Volume<float>& session : sessions) {
    Vector edges = session.grid.spacing;
    std::sort(edges.begin(), edges.end());
    least = least.cwiseMin(edges);
    most = most.cwiseMax(edges);
  }
  return most.cwiseQuotient(least).maxCoeff();
}

/// @return the voxels' size, mm
double writeCommonSpace(Context& context, const LongitudinalSettings& s,
                        const std::vector<Volume<float>>& sessions,
                        const std::optional<Volume<Label>>& atlas, Change& change) {
  const auto average = registration::averageSessions(sessions, context.monitor());
  io::writeVolume(context.output("template.nii.gz"), average.mean);
  change.sessions = static_cast<std::int64_t>(sessions.size());
  change.voxels = voxelRatio(sessions);
  change.correlation = average.leastCorrelation;
  change.turn = 0;
  for (std::size_t n = 0; n < sessions.size(); ++n) {
    const Eigen::Isometry3d& motion = average.toSession[n];
    io::writeVolume(context.output(numbered("session-", n) + ".nii.gz"), average.sessions[n]);
    io::writeTransform(context.output(numbered("to_session-", n) + ".h5"),
                       Eigen::Affine3d(motion.matrix()), {});
    change.turn = std::max(change.turn, Eigen::AngleAxisd(motion.linear()).angle() * 180 / kPi);
  }
  if (atlas) writeAtlas(context, *atlas, *s.atlas, average.toSession[0], average.mean.grid);
  return average.mean.grid.spacing.maxCoeff();
}

std::vector<MeasuredSide> sidesOf(const LongitudinalSettings& s) {
  if (s.hemisphere == pipeline::RunHemisphere::Both) return {{"-L", "L"}, {"-R", "R"}};
  return {{"", std::string(nameOf(s.hemisphere))}};
}

/// `explica run` of the mean, but for its input and atlas.
Json runOfTemplate(const Context& context, const LongitudinalSettings& s) {
  Json values = givenOptions(context, s.run.declaration);
  values["kind"] = "t1";
  values["hemisphere"] = nameOf(s.hemisphere);
  values["steps"] = {"segment", "surface", "sphere", "report"};
  if (values.value("template", "colin27") != "none") {
    values["steps"].insert(values["steps"].end(), {"register", "parcellate"});
  }
  return values;
}

/// In a dry run: what the runs would refuse is refused of the first session as it is.
void checkBeforehand(Context& context, const LongitudinalSettings& s) {
  if (!context.given("dry-run")) return;
  Json values = runOfTemplate(context, s);
  values["INPUT"] = s.sessions.front();
  if (s.atlas) values["atlas"] = *s.atlas;
  context.runCommand(*findCommand("run"), "template", values);
}

/// Takes the mean, then each session, through `explica run`.
Termination runAll(Context& context, const LongitudinalSettings& s) {
  const fs::path out = context.outputFolder();
  Termination worst = Termination::Finished;
  const auto take = [&](const std::string& name, Json values) {
    values["INPUT"] = (out / (name + ".nii.gz")).string();
    const Outcome outcome = context.runCommand(*findCommand("run"), name, values);
    checkpoint(context.monitor());
    if (!reachedGoal(outcome.termination)) worst = outcome.termination;
  };
  Json values = runOfTemplate(context, s);
  if (s.atlas) values["atlas"] = (out / "atlas.nii.gz").string();
  take("template", values);
  const fs::path segment = out / "template/segment";
  values["steps"] = {"segment", "surface"};
  for (auto value = values.begin(); value != values.end();) {  // of steps of the template alone
    const std::string step = value.key().substr(0, value.key().find('.') + 1);
    const bool taken = step.empty() || step == "segment." || step == "surface.";
    value = taken ? std::next(value) : values.erase(value);
  }
  values["segment.mask"] = (segment / "brain_mask.nii.gz").string();
  if (isThere(segment / "to_template.h5")) {
    values["segment.template-transform"] = (segment / "to_template.h5").string();
  }
  for (std::size_t n = 0; n < s.sessions.size(); ++n) take(numbered("session-", n), values);
  return worst;
}

/// As given, or what the first session's file is called up to "_".
std::string personIn(const Context& context, const LongitudinalSettings& s) {
  const std::string file = fs::path(s.sessions.front()).filename().string();
  const Json given = givenOptions(context, s.run.declaration);
  return given.value("regions.person", file.substr(0, file.find_first_of("_.")));
}

/// Half a comparison is of no use: what a failure or a stop leaves goes.
void takeBack(Context& context, const LongitudinalSettings& s) {
  std::vector<std::string> names = {"template"};
  for (std::size_t n = 0; n < s.sessions.size(); ++n) names.push_back(numbered("session-", n));
  std::error_code ignored;
  for (const std::string& name : names) {
    dropSteps(context, name);
    context.dropCommand(name);
    for (const char* account :
         {"run.json", provenance::kSummaryName, "report.html", "thumbnail.png"}) {
      fs::remove(context.outputFolder() / name / account, ignored);
    }
    fs::remove(context.outputFolder() / name, ignored);
    fs::remove(context.outputFolder() / (name + ".nii.gz"), ignored);
    fs::remove(context.outputFolder() / ("to_" + name + ".h5"), ignored);
  }
  for (const char* file : {"atlas.nii.gz", "atlas.tsv", "atlas.nii.txt"}) {
    fs::remove(context.outputFolder() / file, ignored);
  }
}

Termination run(Context& context, const LongitudinalSettings& s) {
  const std::vector<Volume<float>> sessions = readSessions(context, s);
  const std::optional<Volume<Label>> atlas = readAtlas(context, s);
  checkBeforehand(context, s);
  context.judged();
  Change change;
  Termination worst = Termination::Finished;
  Sums sums;
  try {
    double voxel = 0;
    {
      auto step = context.step("sessions");
      voxel = writeCommonSpace(context, s, sessions, atlas, change);
    }
    worst = runAll(context, s);
    for (const MeasuredSide& side : sidesOf(s)) {
      measureChange(context, sessions.size(), side, personIn(context, s), voxel, sums);
    }
  } catch (...) {
    takeBack(context, s);
    throw;
  }
  sums.settle(change);
  context.results(change);
  return worst;
}

}  // namespace

Command longitudinalCommand() {
  return makeCommand<LongitudinalSettings>("longitudinal", declare, run);
}

}  // namespace explica::app
