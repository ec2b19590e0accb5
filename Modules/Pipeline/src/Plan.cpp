// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/Plan.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Study/SubjectFiles.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLabels = 64;  // a T1 has more grey values

// FreeSurfer's numbers, left: white matter, and what the white surface encloses beside it
// (ventricles, thalamus, basal ganglia, accumbens, ventral diencephalon, vessel, choroid plexus,
// hippocampus, amygdala, hypointensities, callosum).
const std::vector<int> kLeftInside = {2, 4, 5, 9, 10, 11, 12, 13, 17, 18, 26, 28, 30, 31, 77, 78};
const std::vector<int> kRightInside = {41, 43, 44, 48, 49, 50, 51, 52, 53, 54, 58, 60, 62, 63, 79};
// Not 24: it is fluid, which SynthSeg puts all around the cortex.
const std::vector<int> kBetween = {14, 15, 16, 72, 80, 85, 192, 251, 252, 253, 254, 255};
constexpr int kLeftCortex = 3;    // FreeSurfer's label
constexpr int kRightCortex = 42;  // FreeSurfer's label

/// Of aparc+aseg (1001 to 1035, 2001 to 2035) and aparc.a2009s+aseg (11101 to 11175, ...).
bool isParcel(Label label, bool left) {
  const Label thousand = label / 1000, within = label % 1000;
  const bool desikan = thousand == (left ? 1 : 2) && within >= 1 && within <= 35;
  const bool destrieux = thousand == (left ? 11 : 12) && within >= 101 && within <= 175;
  return desikan || destrieux;
}

enum class Naming {
  FreeSurfer,   ///< aseg, aparc+aseg, SynthSeg, FastSurfer
  Ribbon,       ///< 2, 3, 41, 42
  ThreeClass,   ///< 1 fluid, 2 grey, 3 white, 4 cut
  BidsClasses,  ///< 1 grey, 2 white, 3 fluid
  Unknown
};

constexpr auto enumWords(Naming) {
  return std::to_array<EnumWord<Naming>>({{Naming::FreeSurfer, "FreeSurfer's labels"},
                                          {Naming::Ribbon, "FreeSurfer's ribbon"},
                                          {Naming::ThreeClass, "1 fluid, 2 grey, 3 white"},
                                          {Naming::BidsClasses, "1 grey, 2 white, 3 fluid"},
                                          {Naming::Unknown, "names not known"}});
}

/// The class of 1, 2, 3 that touches both others most: grey matter lies between the two.
int middleClass(const Volume<Label>& labels) {
  std::array<std::array<std::int64_t, 4>, 4> contacts{};
  forContacts(labels, [&](Label a, Label b) {
    if (a == b || a < 1 || b < 1 || a > 3 || b > 3) return;
    ++contacts[std::min(a, b)][std::max(a, b)];
  });
  // The pair that touches least leaves the class between.
  const auto least = std::min({contacts[1][2], contacts[1][3], contacts[2][3]});
  if (least == contacts[1][3]) return 2;
  return least == contacts[2][3] ? 1 : 3;
}

struct NamedLabels {
  std::set<Label> found;
  Naming naming = Naming::Unknown;
};

/// @param dimension  demanded, if given
NamedLabels nameLabels(const fs::path& file, std::optional<int> dimension = std::nullopt) {
  const Volume<Label> labels = io::readLabels(file, {.dimension = dimension}).volume;
  NamedLabels named{.found = {labels.data.begin(), labels.data.end()}};
  const auto& found = named.found;
  const auto has = [&](Label label) { return found.count(label) != 0; };
  const auto hasCortex = [&](bool left) {
    return has(left ? kLeftCortex : kRightCortex) ||
           std::ranges::any_of(found, [&](Label label) { return isParcel(label, left); });
  };
  if (has(2) && has(41) && hasCortex(true) && hasCortex(false)) {
    named.naming = *found.rbegin() > 42 || has(10) ? Naming::FreeSurfer : Naming::Ribbon;
  } else if (has(2) && *found.rbegin() <= 4) {
    if (has(1) && has(3)) {
      named.naming = middleClass(labels) == 1 ? Naming::BidsClasses : Naming::ThreeClass;
    } else if (has(3)) {
      named.naming = Naming::ThreeClass;
    } else if (has(1)) {
      named.naming = Naming::BidsClasses;
    }
  }
  return named;
}

/// Labels of the cortex of one side, as the volume has them.
std::vector<int> cortexOf(const NamedLabels& labels, bool left) {
  std::vector<int> cortex;
  for (const Label label : labels.found) {
    if (label == (left ? kLeftCortex : kRightCortex) || isParcel(label, left)) {
      cortex.push_back(label);
    }
  }
  return cortex;
}

bool wanted(const PlanOptions& options, RunStep step) {
  return options.steps.empty() || std::ranges::find(options.steps, step) != options.steps.end();
}

std::shared_ptr<Json> values(Json json) {
  return std::make_shared<Json>(std::move(json));
}

Json thicknessValues(const fs::path& file, const NamedLabels& labels, bool left) {
  Json json = {{"SEG", file.string()}};
  std::vector<int> inside;
  std::vector<int> insulated;
  switch (labels.naming) {
    case Naming::ThreeClass:
      inside = {3};
      insulated = {4};
      json["tissue"] = {2};
      break;
    case Naming::BidsClasses:
      inside = {2};
      json["tissue"] = {1};
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
      json["tissue"] = cortexOf(labels, left);
      break;
    case Naming::Unknown:
      return json;
  }
  const auto absent = [&](int label) {  // a volume yet to be made will hold all
    return !labels.found.empty() && !labels.found.contains(label);
  };
  inside.erase(std::remove_if(inside.begin(), inside.end(), absent), inside.end());
  insulated.erase(std::remove_if(insulated.begin(), insulated.end(), absent), insulated.end());
  json["inner"] = inside;
  if (!insulated.empty()) json["insulated"] = insulated;
  return json;
}

Json surfaceValues(const fs::path& file, const NamedLabels& labels, bool left) {
  Json json = {{"SEG", file.string()}};
  switch (labels.naming) {
    case Naming::ThreeClass:
      break;
    case Naming::BidsClasses:
      json["white-label"] = {2};
      json["grey-label"] = {1};
      break;
    case Naming::FreeSurfer:
      if (!labels.found.contains(left ? kLeftCortex : kRightCortex) ||
          cortexOf(labels, left).size() > 1) {
        json["preset"] = "aseg";
        json["grey-label"] = cortexOf(labels, left);
      }
      [[fallthrough]];
    default:
      json["hemisphere"] = left ? "L" : "R";
  }
  return json;
}

Json givenSurfaceValues(const study::SubjectFiles& files, bool left) {
  const study::HemisphereFiles& given = left ? files.left : files.right;
  Json json = {{"white-surface", given.white->string()},
               {"pial-surface", given.pial->string()},
               {"hemisphere", left ? "L" : "R"}};
  if (given.mid) json["mid-surface"] = given.mid->string();
  if (files.layout == study::SubjectLayout::FreeSurfer && files.surfaceVolume) {
    json["surface-space"] = "tkr";
    json["fs-volume"] = files.surfaceVolume->string();
  }
  return json;
}

/// Where the files are: a folder is looked through, a file stands for itself.
study::SubjectFiles filesOf(const fs::path& input, const PlanOptions& options, InputKind kind) {
  study::SubjectFiles files;
  switch (kind) {
    case InputKind::FreeSurfer:
    case InputKind::Bids:
      files = study::findSubjectFiles(input);
      break;
    case InputKind::T1:
      files.t1 = input;
      break;
    default:
      files.labels = input;
  }
  if (options.given == GivenSurfaces::Remake) files.left = files.right = {};
  return files;
}

/// Puts the steps of one hemisphere together.
class Planner {
 public:
  /// @param ending  of the steps' names, where both hemispheres have some
  Planner(study::SubjectFiles files, fs::path out, const PlanOptions& options, bool left,
          std::string ending)
      : files_(std::move(files)),
        out_(std::move(out)),
        options_(options),
        left_(left),
        ending_(std::move(ending)) {}

  Plan make(InputKind kind) {
    plan_.kind = kind;
    plan_.remarks = files_.remarks;
    if (files_.t1) planSegment();
    if (files_.labels) {
      // One slice has a thickness, but no surfaces.
      const bool solid = wanted(options_, RunStep::Surface) || wanted(options_, RunStep::Unfold);
      labels_ = nameLabels(*files_.labels, solid ? std::optional(3) : std::nullopt);
      use("labels", *files_.labels, std::string(nameOf(labels_.naming)));
    }
    const bool given = surfaces().white.has_value();
    if (!given && !files_.labels && !files_.t1) {
      throw InvalidInput(other().white->string() +
                         ": is all there is; this hemisphere has neither surfaces nor labels");
    }
    if (wanted(options_, RunStep::Thickness)) planThickness();
    if (wanted(options_, RunStep::Surface)) planSurface(given);
    planTemplate(given);
    if (wanted(options_, RunStep::Unfold)) planUnfold();
    return std::move(plan_);
  }

 private:
  [[nodiscard]] const study::HemisphereFiles& surfaces() const {
    return left_ ? files_.left : files_.right;
  }
  [[nodiscard]] const study::HemisphereFiles& other() const {
    return left_ ? files_.right : files_.left;
  }

  /// Where `segment` leaves this side.
  [[nodiscard]] fs::path segmented() const { return out_ / "segment" / (left_ ? "left" : "right"); }

  void use(const std::string& role, const fs::path& path, const std::string& meaning = "") {
    plan_.sources.push_back({role, path, meaning});
  }

  void planSegment() {
    use("T1", *files_.t1);
    Json json = {{"T1", files_.t1->string()}};
    if (files_.mask) {
      use("brain mask", *files_.mask);
      json["mask"] = files_.mask->string();
    }
    if (files_.atlas) {
      use("atlas", *files_.atlas);
      json["atlas"] = files_.atlas->string();
    }
    json["hemisphere"] = "both";  // one and the same step for either side
    plan_.steps.push_back({"segment", "segment", {}, values(json)});
    labels_.naming = Naming::ThreeClass;
    needs_ = {"segment"};
  }

  void planThickness() {
    if (!files_.labels && !files_.t1) {
      plan_.remarks.emplace_back(
          "there are no labels: the thickness of voxels and layers are left out");
      return;
    }
    const fs::path labels = files_.labels ? *files_.labels : segmented() / "hemisphere.nii.gz";
    plan_.steps.push_back({"thickness" + ending_, "thickness", needs_,
                           values(thicknessValues(labels, labels_, left_))});
  }

  void planSurface(bool given) {
    Json json;
    std::vector<std::string> needs;
    if (given) {
      use("white surface", *surfaces().white);
      use("pial surface", *surfaces().pial);
      if (surfaces().mid) use("middle surface", *surfaces().mid);
      json = givenSurfaceValues(files_, left_);
    } else if (files_.t1) {
      const fs::path segment = segmented();
      json = {{"inner-level", (segment / "white_share.nii.gz").string()},
              {"outer-level", (segment / "tissue_share.nii.gz").string()},
              {"insulated-mask", (segment / "cut.nii.gz").string()},
              {"image", files_.t1->string()},
              {"hemisphere", left_ ? "L" : "R"}};
      needs = needs_;
    } else {
      json = surfaceValues(*files_.labels, labels_, left_);
      if (files_.image) {
        use("image", *files_.image, "places the borders");
        json["image"] = files_.image->string();
      }
    }
    if (given && surfaces().parcellation) {
      use("regions", *surfaces().parcellation);
      json["parcellation"] = surfaces().parcellation->string();
    } else if (files_.atlas) {
      if (!files_.t1) use("regions", *files_.atlas);
      json["atlas"] = files_.atlas->string();
    } else if (files_.t1 && !given) {
      json["atlas"] = (out_ / "segment" / "atlas.nii.gz").string();
    }
    plan_.steps.push_back({"surface" + ending_, "surface", needs, values(json)});
  }

  /// True if the step is asked for; or if nothing is, and the input is a person's hemisphere.
  [[nodiscard]] bool onTemplate(RunStep step, bool given) const {
    if (!options_.steps.empty()) return wanted(options_, step);
    const bool named = labels_.naming == Naming::FreeSurfer || labels_.naming == Naming::Ribbon;
    return options_.cortexTemplate != "none" && (given || files_.t1 || named);
  }

  void add(const std::string& name, const std::string& command,
           const std::vector<std::string>& needs, Json json) {
    std::vector<std::string> all;
    for (const std::string& need : needs) all.push_back(need + ending_);
    plan_.steps.push_back({name + ending_, command, all, values(std::move(json))});
  }

  /// From one person to others: a sphere, its place on the template, maps there, regions.
  void planTemplate(bool given) {
    const auto folder = [&](const char* step) { return out_ / (step + ending_); };
    const fs::path surface = folder("surface");
    if (onTemplate(RunStep::Sphere, given)) {
      add("sphere", "sphere", {"surface"}, {{"SURFACE", (surface / "white.surf.gii").string()}});
    }
    const std::string side = left_ ? "L" : "R";
    const std::string sphere = (folder("register") / "sphere.reg.surf.gii").string();
    if (onTemplate(RunStep::Register, given)) {
      add("register", "register", {"surface", "sphere"},
          {{"SPHERE", (folder("sphere") / "sphere.surf.gii").string()},
           {"surfaces", surface.string()},
           {"template", options_.cortexTemplate}});
      Json maps = Json::array();
      for (const char* map : {"thickness", "sulc"}) {
        maps.push_back((surface / (std::string(map) + ".shape.gii")).string());
      }
      add("resample", "resample", {"surface", "register"},
          {{"MAP", maps},
           {"amounts", {(surface / "area.shape.gii").string()}},
           {"from", sphere},
           {"to", "fsaverage5"},
           {"space", options_.cortexTemplate}});
    }
    if (onTemplate(RunStep::Parcellate, given)) {
      Json json = {{"SURFACES", folder("register").string()},
                   {"template", options_.cortexTemplate},
                   {"hemisphere", side}};
      if (const auto image = files_.t1 ? files_.t1 : files_.labels) {
        json["volume"] = true;
        json["like"] = image->string();
        json["ribbon"] = surface.string();
      }
      add("parcellate", "parcellate", {"surface", "register"}, json);
      add("regions", "regions", {"surface", "parcellate"},
          {{"SURFACES", surface.string()},
           {"atlas", {(folder("parcellate") / "regions.label.gii").string()}},
           {"hemisphere", side},
           {"person", out_.lexically_normal().filename().string()}});
    }
  }

  void planUnfold() {
    const std::string file = std::string(nameOf(options_.unfolded)) + ".surf.gii";
    const Json json = {{"SURFACE", (out_ / ("surface" + ending_) / file).string()},
                       {"direction", {left_ ? -1 : 1, 0, 0}},
                       {"frames", 40}};
    plan_.steps.push_back({"unfold" + ending_, "unfold", {"surface" + ending_}, values(json)});
  }

  study::SubjectFiles files_;
  fs::path out_;
  const PlanOptions& options_;
  bool left_;
  std::string ending_;
  Plan plan_;
  NamedLabels labels_;
  std::vector<std::string> needs_;  ///< of steps that read what `segment` makes
};

}  // namespace

InputKind detectKind(const fs::path& input) {
  if (isFolder(input)) {
    return study::findSubjectFiles(input).layout == study::SubjectLayout::FreeSurfer
               ? InputKind::FreeSurfer
               : InputKind::Bids;
  }
  const Volume<float> image = io::readScalars(input).volume;
  std::set<float> distinct;
  for (const float value : image.data) {
    if (value != std::floor(value)) return InputKind::T1;
    if (distinct.size() <= 4 * kMostLabels) distinct.insert(value);
  }
  if (distinct.size() <= kMostLabels) return InputKind::Labels;
  // aparc+aseg has more labels than others, but fewer than an image has grey values.
  const auto parcels = std::ranges::count_if(distinct, [](float value) {
    const auto label = static_cast<Label>(value);
    return isParcel(label, true) || isParcel(label, false);
  });
  return distinct.size() <= 4 * kMostLabels && parcels >= 20 ? InputKind::Labels  // of 70 or 150
                                                             : InputKind::T1;
}

bool labelsHaveSides(const fs::path& labels) {
  const Naming naming = nameLabels(labels).naming;
  return naming == Naming::FreeSurfer || naming == Naming::Ribbon;
}

namespace {

/// True if both hemispheres can be told from each other.
bool hasBothSides(const study::SubjectFiles& files) {
  if (files.left.white && files.right.white) return true;
  if (files.labels) return labelsHaveSides(*files.labels);
  return files.t1.has_value();
}

/// Adds what the plan for the other hemisphere has and this one lacks.
void join(Plan& plan, Plan other) {
  for (SourceFile& source : other.sources) {
    const bool known = std::ranges::any_of(plan.sources, [&](const SourceFile& s) {
      return s.role == source.role && s.path == source.path;
    });
    if (!known) plan.sources.push_back(std::move(source));
  }
  for (std::string& remark : other.remarks) {
    if (std::ranges::find(plan.remarks, remark) == plan.remarks.end())
      plan.remarks.push_back(std::move(remark));
  }
  for (PlannedStep& step : other.steps) {
    if (step.name != "segment") plan.steps.push_back(std::move(step));
  }
}

}  // namespace

Plan planRun(const fs::path& input, const fs::path& out, const std::optional<std::string>& atlas,
             const PlanOptions& options) {
  const InputKind kind = options.kind == InputKind::Auto ? detectKind(input) : options.kind;
  study::SubjectFiles files = filesOf(input, options, kind);
  if (atlas) files.atlas = *atlas;
  if (options.hemisphere == RunHemisphere::Both && hasBothSides(files)) {
    Plan plan = Planner(files, out, options, true, "-L").make(kind);
    join(plan, Planner(std::move(files), out, options, false, "-R").make(kind));
    return plan;
  }
  const bool onlyRight = !files.left.white && files.right.white && !files.labels && !files.t1;
  const bool left = options.hemisphere == RunHemisphere::Both
                        ? !onlyRight
                        : options.hemisphere == RunHemisphere::Left;
  return Planner(std::move(files), out, options, left, "").make(kind);
}

Point outermostPoint(const TriangleMesh& mesh, const Vector& direction) {
  const Vector d = direction.normalized();
  const Point centroid = mesh.positions.colwise().mean().transpose();
  double farthest = -kInfinity;
  Point best = centroid;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Vector from = mesh.positions.row(v).transpose() - centroid;
    const double along = from.dot(d);
    if ((from - along * d).norm() > 15 || along <= farthest) continue;
    farthest = along;
    best = mesh.positions.row(v).transpose();
  }
  return best;
}

}  // namespace explica::pipeline
