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
#include <iterator>
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

bool isCortex(Label label, bool left) {
  return label == (left ? kLeftCortex : kRightCortex) || isParcel(label, left);
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
    return std::ranges::any_of(found, [&](Label label) { return isCortex(label, left); });
  };
  if (has(2) && has(41) && hasCortex(true) && hasCortex(false)) {
    named.naming = *found.rbegin() > 42 || has(10) ? Naming::FreeSurfer : Naming::Ribbon;
  } else if (has(2) && *found.rbegin() <= 4) {
    const bool fluidLast = has(1) && (!has(3) || middleClass(labels) == 1);
    if (has(1) || has(3)) named.naming = fluidLast ? Naming::BidsClasses : Naming::ThreeClass;
  }
  return named;
}

/// Labels of the cortex of one side, as the volume has them.
std::vector<int> cortexOf(const NamedLabels& labels, bool left) {
  std::vector<int> cortex;
  std::ranges::copy_if(labels.found, std::back_inserter(cortex),
                       [&](Label label) { return isCortex(label, left); });
  return cortex;
}

/// Labels by what they are for one side: the insulated ones touch it where it is cut.
struct Tissues {
  std::vector<int> inside, cortex, insulated;
};

Tissues tissuesIn(const NamedLabels& labels, bool left) {
  switch (labels.naming) {
    case Naming::ThreeClass:
      return {{3}, {2}, {4}};
    case Naming::BidsClasses:
      return {{2}, {1}, {}};
    case Naming::Ribbon:
      return {{left ? 2 : 41}, {left ? kLeftCortex : kRightCortex}, {left ? 41 : 2}};
    case Naming::FreeSurfer: {
      std::vector<int> others = left ? kRightInside : kLeftInside;
      others.insert(others.end(), kBetween.begin(), kBetween.end());
      return {left ? kLeftInside : kRightInside, cortexOf(labels, left), others};
    }
    default:
      return {};
  }
}

bool wanted(const PlanOptions& options, RunStep step) {
  return options.steps.empty() || std::ranges::find(options.steps, step) != options.steps.end();
}

Json thicknessValues(const std::string& file, const NamedLabels& labels, bool left) {
  Json json = {{"SEG", file}};
  if (labels.naming == Naming::Unknown) return json;
  Tissues tissues = tissuesIn(labels, left);
  const auto absent = [&](int label) {  // a volume yet to be made will hold all
    return !labels.found.empty() && !labels.found.contains(label);
  };
  std::erase_if(tissues.inside, absent);
  std::erase_if(tissues.insulated, absent);
  json["tissue"] = tissues.cortex;
  json["inner"] = tissues.inside;
  if (!tissues.insulated.empty()) json["insulated"] = tissues.insulated;
  return json;
}

Json surfaceValues(const std::string& file, const NamedLabels& labels, bool left) {
  Json json = {{"SEG", file}};
  if (labels.naming == Naming::ThreeClass) return json;
  if (labels.naming == Naming::BidsClasses) {
    json["white-label"] = {2};
    json["grey-label"] = {1};
    return json;
  }
  const std::vector<int> cortex = cortexOf(labels, left);
  if (labels.naming == Naming::FreeSurfer &&
      (cortex.size() > 1 || !labels.found.contains(left ? kLeftCortex : kRightCortex))) {
    json["preset"] = "aseg";
    json["grey-label"] = cortex;
  }
  json["hemisphere"] = left ? "L" : "R";
  return json;
}

/// Where the files are: a folder is looked through, a file stands for itself.
study::SubjectFiles filesOf(const fs::path& input, const PlanOptions& options, InputKind kind) {
  study::SubjectFiles files;
  if (kind == InputKind::FreeSurfer || kind == InputKind::Bids) {
    files = study::findSubjectFiles(input);
  } else {
    (kind == InputKind::T1 ? files.t1 : files.labels) = input;
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
    if (!given_.white && !files_.labels && !files_.t1) {
      throw InvalidInput((left_ ? files_.right : files_.left).white->string() +
                         ": is all there is; this hemisphere has neither surfaces nor labels");
    }
    if (wanted(options_, RunStep::Thickness)) planThickness();
    if (wanted(options_, RunStep::Surface)) planSurface();
    planTemplate();
    if (wanted(options_, RunStep::Unfold)) {
      add("unfold", {"surface"},
          {{"SURFACE", made("surface", std::string(nameOf(options_.unfolded)) + ".surf.gii")},
           {"direction", {left_ ? -1 : 1, 0, 0}},
           {"frames", 40}});
    }
    return std::move(plan_);
  }

 private:
  /// A file that a step writes, or its folder.
  [[nodiscard]] std::string made(const char* step, const fs::path& file = {}) const {
    const fs::path folder = out_ / (step + ending_);
    return (file.empty() ? folder : folder / file).string();
  }

  /// Where `segment`, one and the same step for either side, leaves this one.
  [[nodiscard]] std::string segmented(const char* file) const {
    return (out_ / "segment" / (left_ ? "left" : "right") / file).string();
  }

  void use(const std::string& role, const fs::path& path, const std::string& meaning = "") {
    plan_.sources.push_back({role, path, meaning});
  }

  /// A file, if there is one, as the value of a step's option.
  void give(Json& json, const char* option, const std::string& role,
            const std::optional<fs::path>& path, const std::string& meaning = "") {
    if (!path) return;
    use(role, *path, meaning);
    json[option] = path->string();
  }

  void add(const std::string& command, std::vector<std::string> needs, Json json) {
    const auto named = [&](const std::string& c) { return c == "segment" ? c : c + ending_; };
    for (std::string& need : needs) need = named(need);
    plan_.steps.push_back(
        {named(command), command, std::move(needs), std::make_shared<Json>(std::move(json))});
  }

  void planSegment() {
    Json json;
    give(json, "T1", "T1", files_.t1);
    give(json, "mask", "brain mask", files_.mask);
    give(json, "atlas", "atlas", files_.atlas);
    json["hemisphere"] = "both";
    add("segment", {}, std::move(json));
    labels_.naming = Naming::ThreeClass;
    needs_ = {"segment"};
  }

  void planThickness() {
    if (!files_.labels && !files_.t1) {
      plan_.remarks.emplace_back(
          "there are no labels: the thickness of voxels and layers are left out");
      return;
    }
    const std::string labels =
        files_.labels ? files_.labels->string() : segmented("hemisphere.nii.gz");
    add("thickness", needs_, thicknessValues(labels, labels_, left_));
  }

  void planSurface() {
    Json json;
    const bool ofImage = !given_.white && files_.t1;
    if (given_.white) {
      give(json, "white-surface", "white surface", given_.white);
      give(json, "pial-surface", "pial surface", given_.pial);
      json["hemisphere"] = side_;
      give(json, "mid-surface", "middle surface", given_.mid);
      if (files_.layout == study::SubjectLayout::FreeSurfer && files_.surfaceVolume) {
        json["surface-space"] = "tkr";
        json["fs-volume"] = files_.surfaceVolume->string();
      }
    } else if (ofImage) {
      json = {{"inner-level", segmented("white_share.nii.gz")},
              {"outer-level", segmented("tissue_share.nii.gz")},
              {"insulated-mask", segmented("cut.nii.gz")},
              {"image", files_.t1->string()},
              {"hemisphere", side_}};
    } else {
      json = surfaceValues(files_.labels->string(), labels_, left_);
      give(json, "image", "image", files_.image, "places the borders");
    }
    if (given_.white && given_.parcellation) {
      give(json, "parcellation", "regions", given_.parcellation);
    } else if (files_.atlas) {
      if (!files_.t1) use("regions", *files_.atlas);
      json["atlas"] = files_.atlas->string();
    } else if (ofImage) {
      json["atlas"] = (out_ / "segment" / "atlas.nii.gz").string();
    }
    add("surface", ofImage ? needs_ : std::vector<std::string>{}, std::move(json));
  }

  /// True if the step is asked for; or if nothing is, and the input is a person's hemisphere.
  [[nodiscard]] bool onTemplate(RunStep step) const {
    if (!options_.steps.empty()) return wanted(options_, step);
    const bool named = labels_.naming == Naming::FreeSurfer || labels_.naming == Naming::Ribbon;
    return options_.cortexTemplate != "none" && (given_.white || files_.t1 || named);
  }

  /// From one person to others: a sphere, its place on the template, maps there, regions.
  void planTemplate() {
    if (onTemplate(RunStep::Sphere)) {
      add("sphere", {"surface"}, {{"SURFACE", made("surface", "white.surf.gii")}});
    }
    if (onTemplate(RunStep::Register)) {
      add("register", {"surface", "sphere"},
          {{"SPHERE", made("sphere", "sphere.surf.gii")},
           {"surfaces", made("surface")},
           {"template", options_.cortexTemplate}});
      const Json maps = {made("surface", "thickness.shape.gii"), made("surface", "sulc.shape.gii")};
      add("resample", {"surface", "register"},
          {{"MAP", maps},
           {"amounts", Json::array({made("surface", "area.shape.gii")})},
           {"from", made("register", "sphere.reg.surf.gii")},
           {"to", "fsaverage5"},
           {"space", options_.cortexTemplate}});
    }
    if (onTemplate(RunStep::Parcellate)) {
      Json json = {{"SURFACES", made("register")},
                   {"template", options_.cortexTemplate},
                   {"hemisphere", side_}};
      if (const auto image = files_.t1 ? files_.t1 : files_.labels) {
        json["volume"] = true;
        json["like"] = image->string();
        json["ribbon"] = made("surface");
      }
      add("parcellate", {"surface", "register"}, std::move(json));
      add("regions", {"surface", "parcellate"},
          {{"SURFACES", made("surface")},
           {"atlas", Json::array({made("parcellate", "regions.label.gii")})},
           {"hemisphere", side_},
           {"person", out_.lexically_normal().filename().string()}});
    }
  }

  study::SubjectFiles files_;
  fs::path out_;
  const PlanOptions& options_;
  bool left_;
  std::string ending_;
  std::string side_ = left_ ? "L" : "R";
  const study::HemisphereFiles& given_ = left_ ? files_.left : files_.right;
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
  const auto planOf = [&](bool left, const char* ending) {
    return Planner(files, out, options, left, ending).make(kind);
  };
  if (options.hemisphere == RunHemisphere::Both && hasBothSides(files)) {
    Plan plan = planOf(true, "-L");
    join(plan, planOf(false, "-R"));
    return plan;
  }
  const bool onlyRight = !files.left.white && files.right.white && !files.labels && !files.t1;
  const bool both = options.hemisphere == RunHemisphere::Both;
  return planOf(both ? !onlyRight : options.hemisphere == RunHemisphere::Left, "");
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
