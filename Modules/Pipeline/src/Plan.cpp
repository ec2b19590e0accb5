// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/Plan.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/VolumeFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLabels = 64;  // a T1 has more grey values
constexpr double kPatchReach = 15;       // mm
constexpr int kFrames = 40;              // of the evolution that the report plays

// FreeSurfer's numbers, left: white matter, and what the white surface encloses beside it
// (ventricles, thalamus, basal ganglia, accumbens, ventral diencephalon, vessel, choroid plexus,
// hippocampus, amygdala, hypointensities, callosum).
const std::vector<int> kLeftInside = {2, 4, 5, 9, 10, 11, 12, 13, 17, 18, 26, 28, 30, 31, 77, 78};
const std::vector<int> kRightInside = {41, 43, 44, 48, 49, 50, 51, 52, 53, 54, 58, 60, 62, 63, 79};
const std::vector<int> kBetween = {14, 15, 16, 24, 72, 80, 85, 192, 251, 252, 253, 254, 255};
constexpr int kLeftCortex = 3;
constexpr int kRightCortex = 42;

enum class Naming { FreeSurfer, Ribbon, ThreeClass, Unknown };

Naming namingOf(const std::set<Label>& found) {
  const auto has = [&](Label label) { return found.count(label) != 0; };
  if (has(kLeftCortex) && has(kRightCortex) && has(2) && has(41)) {
    return *found.rbegin() > 42 || has(10) ? Naming::FreeSurfer : Naming::Ribbon;
  }
  if (has(2) && has(3) && *found.rbegin() <= 4) return Naming::ThreeClass;
  return Naming::Unknown;
}

bool wanted(const PlanOptions& options, RunStep step) {
  return options.steps.empty() ||
         std::find(options.steps.begin(), options.steps.end(), step) != options.steps.end();
}

std::shared_ptr<Json> values(Json json) {
  return std::make_shared<Json>(std::move(json));
}

/// @param found  labels that the volume holds; empty if it is yet to be made and will hold all
Json thicknessValues(const fs::path& labels, Naming naming, bool left,
                     const std::set<Label>& found) {
  Json json = {{"SEG", labels.string()}};
  std::vector<int> inside;
  std::vector<int> insulated;
  switch (naming) {
    case Naming::ThreeClass:
      inside = {3};
      insulated = {4};
      json["tissue"] = {2};
      break;
    case Naming::Ribbon:
      inside = {left ? 2 : 41};
      insulated = {left ? 41 : 2};
      json["tissue"] = {left ? kLeftCortex : kRightCortex};
      break;
    case Naming::FreeSurfer:
      // The other hemisphere's inside and the stem touch ours where it is cut.
      inside = left ? kLeftInside : kRightInside;
      insulated = left ? kRightInside : kLeftInside;
      insulated.insert(insulated.end(), kBetween.begin(), kBetween.end());
      json["tissue"] = {left ? kLeftCortex : kRightCortex};
      break;
    case Naming::Unknown:
      return json;
  }
  const auto absent = [&](int label) { return !found.empty() && found.count(label) == 0; };
  inside.erase(std::remove_if(inside.begin(), inside.end(), absent), inside.end());
  insulated.erase(std::remove_if(insulated.begin(), insulated.end(), absent), insulated.end());
  json["inner"] = inside;
  if (!insulated.empty()) json["insulated"] = insulated;
  return json;
}

std::set<Label> labelsIn(const fs::path& file) {
  const Volume<Label> labels = io::readLabels(file).volume;
  return {labels.data.begin(), labels.data.end()};
}

}  // namespace

InputKind detectKind(const fs::path& input) {
  if (fs::is_directory(input)) {
    if (fs::exists(input / "mri" / "ribbon.mgz")) return InputKind::FreeSurfer;
    throw InvalidInput(
        input.string() +
        ": holds no mri/ribbon.mgz; give a T1, a label volume or a FreeSurfer subject directory");
  }
  const Volume<float> image = io::readScalars(input).volume;
  std::set<float> distinct;
  for (const float value : image.data) {
    if (value != std::floor(value)) return InputKind::T1;
    if (distinct.size() <= 4 * kMostLabels) distinct.insert(value);
  }
  const bool freeSurfer =
      distinct.count(2) + distinct.count(3) + distinct.count(41) + distinct.count(42) == 4 &&
      distinct.size() <= 4 * kMostLabels;
  const bool consecutive = distinct.size() > kMostLabels;
  return (freeSurfer && !consecutive) || distinct.size() <= kMostLabels ? InputKind::Labels
                                                                        : InputKind::T1;
}

std::vector<PlannedStep> planRun(const fs::path& input, const fs::path& out,
                                 const std::optional<std::string>& atlas,
                                 const PlanOptions& options) {
  const bool left = options.hemisphere == RunHemisphere::Left;
  const std::string side = left ? "L" : "R";
  std::vector<PlannedStep> plan;
  fs::path labels;
  std::set<Label> found;
  Naming naming = Naming::ThreeClass;
  std::vector<std::string> needs;
  switch (options.kind) {
    case InputKind::Auto:
      throw InvalidInput("kind: found 'auto', expected the kind that detectKind finds");
    case InputKind::T1: {
      const bool more = wanted(options, RunStep::Thickness) || wanted(options, RunStep::Surface) ||
                        wanted(options, RunStep::Unfold);
      if (!atlas && more) {
        throw InvalidInput(
            input.string() +
            ": is taken for a T1, whose hemispheres an atlas must tell apart; give --atlas FILE in "
            "its space, or --kind labels, or --steps segment,report");
      }
      Json json = {{"T1", input.string()}};
      if (atlas) {
        json["atlas"] = *atlas;
        json["hemisphere"] = side;
      }
      plan.push_back({"segment", "segment", {}, values(json)});
      labels = out / "segment" / "hemisphere.nii.gz";
      needs = {"segment"};
      break;
    }
    case InputKind::Labels:
      labels = input;
      found = labelsIn(labels);
      naming = namingOf(found);
      break;
    case InputKind::FreeSurfer:
      labels = input / "mri" / "ribbon.mgz";
      found = labelsIn(labels);
      naming = Naming::Ribbon;
      break;
  }

  if (wanted(options, RunStep::Thickness)) {
    plan.push_back(
        {"thickness", "thickness", needs, values(thicknessValues(labels, naming, left, found))});
  }
  if (wanted(options, RunStep::Surface)) {
    Json json;
    if (options.kind == InputKind::T1) {
      const fs::path segment = out / "segment";
      json = {{"inner-level", (segment / "white_share.nii.gz").string()},
              {"outer-level", (segment / "tissue_share.nii.gz").string()},
              {"insulated-mask", (segment / "cut.nii.gz").string()},
              {"hemisphere", side}};
    } else {
      json = {{"SEG", labels.string()}};
      if (naming != Naming::ThreeClass) json["hemisphere"] = side;
    }
    plan.push_back({"surface", "surface", needs, values(json)});
  }
  if (wanted(options, RunStep::Unfold)) {
    const Json json = {
        {"SURFACE",
         (out / "surface" / (std::string(nameOf(options.unfolded)) + ".surf.gii")).string()},
        {"direction", {left ? -1 : 1, 0, 0}},
        {"surround", "none"},  // a patch alone opens all the way
        {"frames", kFrames}};
    plan.push_back({"unfold", "unfold", {"surface"}, values(json)});
  }
  return plan;
}

Point outermostPoint(const TriangleMesh& mesh, const Vector& direction) {
  const Vector d = direction.normalized();
  const Point centroid = mesh.positions.colwise().mean().transpose();
  double farthest = -kInfinity;
  Point best = centroid;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Vector from = mesh.positions.row(v).transpose() - centroid;
    const double along = from.dot(d);
    if ((from - along * d).norm() > kPatchReach || along <= farthest) continue;
    farthest = along;
    best = mesh.positions.row(v).transpose();
  }
  return best;
}

}  // namespace explica::pipeline
