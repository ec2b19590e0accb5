// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Results.h"
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

/// "left: " where there are two sides to tell apart.
std::string sideWord(const StepFolder& step) {
  return step.side().empty() ? "" : " (" + step.side() + ")";
}

/// Where a heart is open, how its segments are oriented, and how much of its wall is left out.
std::vector<ReportFlag> heartFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  if (step.command != "heart") return flags;
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
  std::string why = readable(static_cast<double>(same)) + " files unchanged since the records";
  if (others > 0) why += ", " + readable(static_cast<double>(others)) + " changed: " + names;
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
    std::ranges::replace(name, '-', ' ');
    flags.push_back({accepted ? FlagLevel::Notice : FlagLevel::Bad, name + sideWord(step) + ":",
                     why + (accepted ? " (accepted)" : ""), kTissuePlace});
  }
  return flags;
}

/// Where a reader sees what a step warns of.
std::string placeOf(const std::string& step) {
  constexpr std::array kPlaces = {std::pair{"Segment", kTissuePlace},
                                  std::pair{"Thickness", kOutlinePlace},
                                  std::pair{"Surface", kOutlinePlace},
                                  std::pair{"Unfold", kPatchPlace}, std::pair{"Flat", kFlatPlace}};
  for (const auto& [name, place] : kPlaces) {
    if (step.starts_with(name)) return place;
  }
  return "";
}

/// Where a reader sees a result, if not where its step is shown.
std::string placeOf(const StepFolder& step, const std::string& key) {
  constexpr std::array kPlaces = {std::pair{"self_intersections", kPatchPlace},
                                  std::pair{"self_intersections_final", kCrossingPlace},
                                  std::pair{"area_error_mean", kDistortionPlace},
                                  std::pair{"seen_final", kPatchPlace}};
  for (const auto& [name, place] : kPlaces) {
    if (key == name) return place;
  }
  return placeOf(titleOf(step.name));
}

/// What the record says of results with limits.
std::vector<ReportFlag> judgedFlags(const StepFolder& step) {
  std::vector<ReportFlag> flags;
  const Json meanings = step.record.value("meanings", Json::object());
  for (const auto& [key, meaning] : meanings.items()) {
    if (!meaning.contains("judgement")) continue;
    const auto judgement = valueOf<Judgement>(meaning["judgement"].get<std::string>());
    const std::string title = meaning.value("title", key);
    flags.push_back({judgement == Judgement::Good   ? FlagLevel::Good
                     : judgement == Judgement::Look ? FlagLevel::Notice
                                                    : FlagLevel::Bad,
                     title + sideWord(step) + ":",
                     meaning.value("sentence", "").substr(title.size() + 2), placeOf(step, key)});
  }
  return flags;
}

/// A patch that was cut out is drawn without the surface that it came from.
std::vector<ReportFlag> detachedFlags(const StepFolder& step) {
  if (step.command != "unfold" || step.text("surround") != "none") return {};
  return {{FlagLevel::Notice, "Unfolded alone" + sideWord(step) + ":",
           "the patch was cut out, and is drawn apart from the surface; laid back it would cross "
           "the rest at " +
               readable(step.number("crossings_with_rest").value_or(kNaN)) + " pairs of faces",
           kPatchPlace}};
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

/// Why a step is doubted or to be looked at, where none of its flags says so: of runs within it.
std::vector<ReportFlag> flagsOfRuns(const StepFolder& step, const std::vector<ReportFlag>& flags) {
  const std::string verdict = step.summary.value("verdict", "");
  const FlagLevel level = verdict == "doubtful" ? FlagLevel::Bad : FlagLevel::Notice;
  const bool isSaid =
      std::ranges::any_of(flags, [&](const ReportFlag& flag) { return flag.level >= level; });
  if (isSaid || (verdict != "doubtful" && verdict != "look")) return {};
  std::vector<ReportFlag> reasons;
  const Json listed = step.summary.value("reasons", Json::array());
  for (const Json& reason : listed) {
    reasons.push_back({level, titleOf(step.command) + ":", readable(reason), ""});
  }
  return reasons;
}

/// Takes away links to what this page does not show.
void dropIdleLinks(report::ReportContent& content) {
  std::set<std::string> places;
  if (!content.evolutions.empty()) places.insert(kPatchPlace);
  if (content.slices) places.insert(content.slices->id);
  for (const auto& shown : content.mosaics) places.insert(shown.id);
  for (const auto& shown : content.views) places.insert(shown.id);
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
    return std::ranges::any_of(flags, [&](const ReportFlag& other) {
      return other.level > flag.level && other.why == flag.why;
    });
  };
  std::vector<ReportFlag> kept;
  std::ranges::copy_if(flags, std::back_inserter(kept),
                       [&](const ReportFlag& flag) { return !repeated(flag); });
  flags = std::move(kept);
}

}  // namespace

void flagSteps(ResultFolder& results) {
  report::ReportContent& content = results.content();
  for (const report::ReportStep& step : content.steps) {
    using enum report::StepState;
    const auto say = [&](FlagLevel level, const char* how) {
      content.flags.push_back({level, step.name + how, step.message});
    };
    if (step.state == Failed) say(FlagLevel::Bad, " failed:");
    if (step.state == StoppedEarly) say(FlagLevel::Notice, " stopped early:");
    if (step.state == Interrupted) say(FlagLevel::Notice, " was interrupted:");
    if (step.state == Missing) say(FlagLevel::Notice, " was not run:");
    for (const std::string& warning : step.warnings)
      content.flags.push_back({FlagLevel::Remark, step.name + ":", warning, placeOf(step.name)});
  }
  for (const StepFolder& step : results.steps()) {
    results.attempt("Flags of " + titleOf(step.name), [&] {
      std::vector<ReportFlag> flags;
      for (const auto find : {doubtFlags, ownFlags, judgedFlags, detachedFlags, heartFlags}) {
        std::ranges::move(find(step), std::back_inserter(flags));
      }
      std::ranges::move(flagsOfRuns(step, flags), std::back_inserter(flags));
      std::ranges::move(flags, std::back_inserter(content.flags));
    });
  }
  results.attempt("Comparison of files", [&] { judgeFiles(results); });
  dropIdleLinks(content);
  dropRepeated(content.flags);
  std::ranges::stable_sort(content.flags, [](const auto& a, const auto& b) {
    return static_cast<int>(a.level) > static_cast<int>(b.level);
  });
}

}  // namespace explica::pipeline
