// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Provenance/Doubts.h"
#include "Explica/Provenance/Verify.h"
#include "ReportParts.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>

namespace explica::pipeline {
namespace {

using report::FlagLevel;
using report::ReportFlag;

constexpr double kAreaErrorGood = 0.02;  // mean: areas on a printed map are trusted to a few %
constexpr double kAreaErrorBad = 0.10;   // mean: more is seen by eye
constexpr double kOpened = 0.95;         // average visibility and seen share of what counts as open
constexpr double kStretchGood = 2;  // mean area ratio of what joins a patch to its surroundings
constexpr double kStretchMost = 8;  // of a single one of its faces

/// "left: " where there are two sides to tell apart.
std::string sideWord(const StepFolder& step) {
  return step.side().empty() ? "" : " (" + step.side() + ")";
}

std::vector<ReportFlag> surfaceFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  const std::string side = sideWord(step);
  if (const auto chi = step.number("euler_characteristic");
      chi && step.summary.value("closed_manifold", true)) {
    flags.push_back({*chi == 2 ? FlagLevel::Good : FlagLevel::Bad, "Topology" + side + ":",
                     "Euler characteristic " + readable(*chi) +
                         (*chi == 2 ? ", a sphere's" : ", not a sphere's 2"),
                     kOutlinePlace});
  }
  if (const auto defects = step.number("defects_corrected"); defects && *defects > 0) {
    flags.push_back({FlagLevel::Notice, "Topology corrected" + side + ":",
                     readable(*defects) + " defects, " +
                         readable(step.number("voxels_changed").value_or(0)) +
                         " voxels changed (topology.tsv lists them)",
                     kCorrectedPlace});
  }
  if (const auto pairs = step.number("self_intersections")) {
    flags.push_back(
        {*pairs == 0 ? FlagLevel::Good : FlagLevel::Bad, "Surface meets itself" + side + ":",
         *pairs == 0 ? "nowhere, by an exact test" : "at " + readable(*pairs) + " pairs of faces",
         kThicknessPlace});
  }
  return flags;
}

std::vector<ReportFlag> thicknessFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  if (const auto recovered = step.number("sulcal_voxels_recovered"); recovered && *recovered > 0) {
    flags.push_back({FlagLevel::Notice, "Hidden sulci recovered" + sideWord(step) + ":",
                     readable(*recovered) + " voxels changed", kOutlinePlace});
  }
  return flags;
}

ReportFlag crossingFlag(const StepFolder& step, double pairs,
                        const std::string& what = "Unfolded surface") {
  const double before = step.number("self_intersections_initial").value_or(0);
  const FlagLevel level =
      pairs == 0 ? FlagLevel::Good : (pairs <= before ? FlagLevel::Notice : FlagLevel::Bad);
  return {level, what + " meets itself" + sideWord(step) + ":",
          pairs == 0
              ? "nowhere, by an exact test"
              : "at " + readable(pairs) + " pairs of faces, " + readable(before) + " at the start",
          pairs > 0 && pairs <= before ? kCrossingPlace : kPatchPlace};
}

/// How the patch lies beside the surface that it came from.
std::vector<ReportFlag> surroundingFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  const bool detached = step.text("surround") == "none";
  if (const auto pairs = step.number("crossings_with_rest"); pairs && !detached) {
    flags.push_back({*pairs == 0 ? FlagLevel::Good : FlagLevel::Bad,
                     "Patch and its surroundings" + sideWord(step) + ":",
                     *pairs == 0 ? "cross nowhere, by an exact test"
                                 : "cross at " + readable(*pairs) + " pairs of faces",
                     kPatchPlace});
  }
  if (detached) {
    flags.push_back({FlagLevel::Notice, "Unfolded alone" + sideWord(step) + ":",
                     "the patch was cut out, and is drawn apart from the surface; laid back it "
                     "would cross the rest at " +
                         readable(step.number("crossings_with_rest").value_or(kNaN)) +
                         " pairs of faces",
                     kPatchPlace});
  }
  if (const auto stretch = step.number("collar_stretch_mean"); stretch && !detached) {
    const double most = step.number("collar_stretch_max").value_or(0);
    const bool little = *stretch <= kStretchGood && most <= kStretchMost;
    flags.push_back({little ? FlagLevel::Good : FlagLevel::Notice,
                     "What joins patch and surroundings" + sideWord(step) + ":",
                     "its faces are stretched to " + readable(*stretch) + " times their area, " +
                         readable(step.number("collar_stretch_max").value_or(kNaN)) + " at most",
                     kPatchPlace});
  }
  return flags;
}

ReportFlag areaFlag(const StepFolder& step, double error) {
  const FlagLevel level = error < kAreaErrorGood  ? FlagLevel::Good
                          : error < kAreaErrorBad ? FlagLevel::Notice
                                                  : FlagLevel::Bad;
  return {level, "Areas kept" + sideWord(step) + ":",
          "mean error " + percent(error) + ", largest " +
              percent(step.number("area_error_max").value_or(kNaN)),
          kDistortionPlace};
}

std::vector<ReportFlag> unfoldFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  const std::string side = sideWord(step);
  if (const auto pairs = step.number("self_intersections_final")) {
    flags.push_back(crossingFlag(step, *pairs));
  }
  for (ReportFlag& flag : surroundingFlags(step)) flags.push_back(std::move(flag));
  const std::string held = step.text("flag");
  if (!held.empty()) {
    flags.push_back({FlagLevel::Bad, "Unfolding " + held + side + ":",
                     "the result is not what was asked for; the warnings below say why",
                     kPatchPlace});
  }
  if (const auto area = step.number("area_error_mean")) flags.push_back(areaFlag(step, *area));
  if (const auto visibility = step.number("visibility_final")) {
    const double seen = step.number("seen_final").value_or(kNaN);
    flags.push_back(
        {*visibility > kOpened && !(seen <= kOpened) ? FlagLevel::Good : FlagLevel::Notice,
         "Seen from the viewpoint" + side + ":",
         percent(seen) + " of the area, at average visibility " + readable(*visibility),
         kPatchPlace});
  }
  return flags;
}

std::vector<ReportFlag> flattenFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  const auto turned = step.number("turned_over"), crossings = step.number("rim_crossings");
  if (turned && crossings) {
    const bool sound = *turned == 0 && *crossings == 0;
    flags.push_back({sound ? FlagLevel::Good : FlagLevel::Bad, "One-to-one" + sideWord(step) + ":",
                     sound ? "no face turned over, no part on another, by an exact test"
                           : readable(*turned) + " faces turned over, " + readable(*crossings) +
                                 " pairs of rim edges that meet",
                     kFlatPlace});
  }
  const auto area = step.number("area_error_mean"), goal = step.number("area_tolerance");
  if (area && goal) {
    constexpr double kRounding = 1.02;
    flags.push_back({*area <= kRounding * *goal ? FlagLevel::Good : FlagLevel::Notice,
                     "Areas kept" + sideWord(step) + ":",
                     "mean error " + percent(*area) + ", asked for " + percent(*goal),
                     kDistortionPlace});
  }
  return flags;
}

std::vector<ReportFlag> repairFlags(const StepFolder& step) {
  const auto before = step.number("pairs_before"), after = step.number("pairs_after");
  if (!before || !after) return {};
  const std::string said = *before == 0 ? "no faces crossed"
                                        : readable(*before - *after) + " of " + readable(*before) +
                                              " crossing pairs of faces parted";
  return {
      {*after == 0 ? FlagLevel::Good : FlagLevel::Bad, "Parted" + sideWord(step) + ":", said, ""}};
}

/// How much of each volume is known on the cortex.
std::vector<ReportFlag> sampleFlags(const StepFolder& step) {
  constexpr std::string_view kKey = "known_fraction_";
  constexpr double kNearlyAll = 0.95;
  std::vector<ReportFlag> flags;
  for (const auto& [key, value] : step.summary.items()) {
    if (key.rfind(kKey, 0) != 0 || !value.is_number()) continue;
    const double share = value.get<double>();
    flags.push_back({share >= kNearlyAll ? FlagLevel::Good : FlagLevel::Notice,
                     key.substr(kKey.size()) + " is known" + sideWord(step) + ":",
                     "at " + percent(share) + " of the places where it was asked for",
                     step.has("profiles.tsv") ? kSampledPlace : ""});
  }
  return flags;
}

std::vector<ReportFlag> inflateFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  const std::string side = sideWord(step);
  if (const auto pairs = step.number("self_intersections_final")) {
    flags.push_back(crossingFlag(step, *pairs, "Inflated surface"));
  }
  const std::string flag = step.text("flag");
  if (!flag.empty()) {
    flags.push_back({FlagLevel::Bad, "Inflation " + flag + side + ":",
                     "the result is not what was asked for; the warnings below say why",
                     kPatchPlace});
  }
  if (const auto area = step.number("area_error_mean")) flags.push_back(areaFlag(step, *area));
  if (const auto visibility = step.number("visibility_final")) {
    flags.push_back({*visibility > kOpened ? FlagLevel::Good : FlagLevel::Notice,
                     "Seen from all around" + side + ":",
                     percent(step.number("seen_final").value_or(kNaN)) +
                         " of the area from somewhere, at global visibility " +
                         readable(*visibility),
                     kPatchViewsPlace});
  }
  return flags;
}

/// Where a heart is open, how its segments are oriented, and how much of its wall is left out.
std::vector<ReportFlag> heartFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  if (const auto open = step.number("open_share_ed");
      open && step.summary.value("plausible", true)) {
    flags.push_back({FlagLevel::Good, "Open at its base:",
                     percent(*open) + " of the cavity's surface at end-diastole has no wall", ""});
  }
  const std::string orientation = step.text("orientation");
  if (!orientation.empty()) {
    const bool known = orientation != "none";
    flags.push_back({known ? FlagLevel::Good : FlagLevel::Notice, "Orientation of the segments:",
                     known ? "by " + orientation : "not known; segments have numbers, not names",
                     ""});
  }
  double left = 0;
  for (const char* cause : {"opening", "valve", "cap", "unreached"}) {
    left += step.number(std::string("voxels_left_out_") + cause + "_ed").value_or(0);
  }
  if (const auto counted = step.number("voxels_counted_ed"); counted && *counted > 0) {
    flags.push_back({left == 0 ? FlagLevel::Good : FlagLevel::Notice, "Left out of the means:",
                     percent(left / (left + *counted)) +
                         " of the wall at end-diastole: openings, valve plane, apex",
                     ""});
  }
  return flags;
}

std::vector<ReportFlag> polygonFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  constexpr double kLengthGood = 1e-3;  // of an edge
  if (const auto pairs = step.number("self_intersections_final")) {
    flags.push_back({*pairs == 0 ? FlagLevel::Good : FlagLevel::Bad, "Polygon meets itself:",
                     *pairs == 0 ? "nowhere" : "at " + readable(*pairs) + " pairs of edges", ""});
  }
  if (const auto error = step.number("length_error_max")) {
    flags.push_back({*error < kLengthGood ? FlagLevel::Good : FlagLevel::Notice,
                     "Lengths kept:", "largest error of an edge " + percent(*error), ""});
  }
  if (const auto visibility = step.number("visibility_final")) {
    flags.push_back({*visibility > kOpened ? FlagLevel::Good : FlagLevel::Notice,
                     "Seen from the viewpoint:",
                     percent(step.number("seen_final").value_or(kNaN)) +
                         " of the length, at average visibility " + readable(*visibility),
                     ""});
  }
  return flags;
}

/// A fit is judged by how far it is from its target beside the size of the shape.
std::vector<ReportFlag> embedFlags(const StepFolder& step) {
  constexpr double kClose = 0.05;  // of the annulus's inner radius
  const auto distance = step.number("distance_mean"), most = step.number("distance_max"),
             radius = step.number("inner_radius");
  if (!distance || !most || !radius) return {};
  return {{*most < kClose * *radius ? FlagLevel::Good : FlagLevel::Notice,
           "Shape beside its target:",
           readable(*distance) + " mm apart on average, " + readable(*most) + " mm at most", ""}};
}

/// Whether what lies on the disk is what the records say was read and written.
void judgeFiles(ResultFolder& results) {
  using provenance::FileState;
  constexpr std::size_t kNamed = 5;
  std::size_t same = 0, others = 0;
  std::string names;
  for (const StepFolder& step : results.steps()) {
    for (const auto& file : provenance::verifyRecord(step.folder / provenance::kRecordName).files) {
      if (file.state == FileState::Same || file.state == FileState::Unhashed) {
        ++same;
      } else if (++others <= kNamed) {
        names += (names.empty() ? "" : ", ") + file.path.filename().string() +
                 (file.state == FileState::Missing ? " is gone" : " is another");
      }
    }
  }
  std::string why = readable(static_cast<double>(same)) + " files are what the records say";
  if (others > 0) why += ", " + readable(static_cast<double>(others)) + " are not: " + names;
  if (others > kNamed) why += ", ...";
  results.content().flags.push_back(
      {others == 0 ? FlagLevel::Good : FlagLevel::Notice, "Inputs and outputs:", why});
}

/// What the program itself could not vouch for: the list "flags" of a summary.
std::vector<ReportFlag> ownFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  const Json listed = step.summary.value("flags", Json::array());
  if (!listed.is_array()) return flags;
  for (const Json& flag : listed) {
    if (!flag.is_object()) continue;
    std::string why = flag.value("message", "");
    if (why.empty() && flag.contains("value")) why = readable(flag["value"]);
    const bool accepted = flag.value("accepted", false);
    std::string name = inWords(flag.value("name", "implausible"));
    std::replace(name.begin(), name.end(), '-', ' ');
    flags.push_back({accepted ? FlagLevel::Notice : FlagLevel::Bad, name + sideWord(step) + ":",
                     why + (accepted ? " (accepted)" : ""), kTissuePlace});
  }
  return flags;
}

/// What of the inputs was cut, guessed or contradicted.
std::vector<ReportFlag> doubtFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  for (const provenance::Doubt& doubt : provenance::kDoubts) {
    const auto count = step.number(doubt.key);
    if (!count || *count == 0) continue;
    flags.push_back({FlagLevel::Notice, doubt.what + sideWord(step) + ":",
                     readable(*count) + " " + doubt.meaning + " (" + step.command + ")", ""});
  }
  return flags;
}

std::vector<ReportFlag> flagsOf(const StepFolder& step) {
  if (step.command == "surface") return surfaceFlags(step);
  if (step.command == "thickness") return thicknessFlags(step);
  if (step.command == "unfold") return unfoldFlags(step);
  if (step.command == "flatten") return flattenFlags(step);
  if (step.command == "repair") return repairFlags(step);
  if (step.command == "sample") return sampleFlags(step);
  if (step.command == "inflate") return inflateFlags(step);
  if (step.command == "heart") return heartFlags(step);
  if (step.command == "polygon") return polygonFlags(step);
  if (step.command == "embed") return embedFlags(step);
  return {};
}

/// Where a reader sees what a step warns of.
std::string placeOf(const std::string& step) {
  constexpr std::array kPlaces = {std::pair{"Segment", kTissuePlace},
                                  std::pair{"Thickness", kUnknownPlace},
                                  std::pair{"Surface", kOutlinePlace},
                                  std::pair{"Unfold", kPatchPlace}, std::pair{"Flat", kFlatPlace}};
  for (const auto& [name, place] : kPlaces) {
    if (step.starts_with(name)) return place;
  }
  return "";
}

/// Takes away links to what this page does not show.
void dropIdleLinks(report::ReportContent& content) {
  std::set<std::string> places;
  if (!content.evolutions.empty()) places.insert(kPatchPlace);
  for (const auto& shown : content.mosaics) places.insert(shown.id);
  for (const auto& shown : content.views) places.insert(shown.id);
  for (const auto& shown : content.pictures) places.insert(shown.id);
  for (const auto& shown : content.drawings) places.insert(shown.id);
  for (const auto& shown : content.charts) places.insert(shown.id);
  for (const auto& shown : content.tables) places.insert(shown.id);
  for (ReportFlag& flag : content.flags) {
    if (!places.contains(flag.see)) flag.see.clear();
  }
}

/// Of flags that say the same the worst is kept: a warning may be a flag of the summary, too.
void dropRepeated(std::vector<ReportFlag>& flags) {
  const auto repeated = [&flags](const ReportFlag& flag) {
    return std::any_of(flags.begin(), flags.end(), [&](const ReportFlag& other) {
      return other.level > flag.level && other.why == flag.why;
    });
  };
  std::vector<ReportFlag> kept;
  std::copy_if(flags.begin(), flags.end(), std::back_inserter(kept),
               [&](const ReportFlag& flag) { return !repeated(flag); });
  flags = std::move(kept);
}

}  // namespace

void flagSteps(ResultFolder& results) {
  report::ReportContent& content = results.content();
  for (const report::ReportStep& step : content.steps) {
    if (step.state == report::StepState::Failed)
      content.flags.push_back({FlagLevel::Bad, step.name + " failed:", step.message});
    if (step.state == report::StepState::StoppedEarly)
      content.flags.push_back({FlagLevel::Notice, step.name + " stopped early:", step.message});
    if (step.state == report::StepState::Interrupted)
      content.flags.push_back({FlagLevel::Notice, step.name + " was interrupted:", step.message});
    if (step.state == report::StepState::Missing)
      content.flags.push_back({FlagLevel::Notice, step.name + " was not run:", step.message});
    for (const std::string& warning : step.warnings)
      content.flags.push_back({FlagLevel::Notice, step.name + ":", warning, placeOf(step.name)});
  }
  for (const StepFolder& step : results.steps()) {
    results.attempt("Flags of " + titleOf(step.name), [&] {
      for (ReportFlag& flag : doubtFlags(step)) content.flags.push_back(std::move(flag));
      for (ReportFlag& flag : ownFlags(step)) content.flags.push_back(std::move(flag));
      for (ReportFlag& flag : flagsOf(step)) content.flags.push_back(std::move(flag));
    });
  }
  results.attempt("Comparison of files", [&] { judgeFiles(results); });
  dropIdleLinks(content);
  dropRepeated(content.flags);
  std::stable_sort(content.flags.begin(), content.flags.end(), [](const auto& a, const auto& b) {
    return static_cast<int>(a.level) > static_cast<int>(b.level);
  });
}

}  // namespace explica::pipeline
