// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/DepthProfiles.h"
#include "Explica/Report/Chart.h"
#include "ReportParts.h"

#include <algorithm>
#include <set>

namespace explica::pipeline {
namespace {

constexpr std::size_t kMostRegions = 11;                       // with a chart of their own
constexpr std::size_t kMostRows = 80;                          // of a table
constexpr std::size_t kMostCourses = 5;                        // depths over time in one chart
constexpr const char* kDepthAxis = "depth (0 white, 1 pial)";  // in words

report::Series seriesOf(const DepthProfile& profile, const std::string& name) {
  report::Series line{name, {}, {}};
  for (const auto& [depth, at] : profile.depths) {
    line.x.push_back(depth);
    line.y.push_back(at.average());
    line.spread.push_back(at.spread());
  }
  return line;
}

/// A chart a region on one scale, the mean with a band of one standard deviation to either side,
/// and the mean of all for comparison.
void chartProfiles(ResultFolder& results, const VolumeProfiles& profiles) {
  const DepthProfile* whole = profiles.all();
  std::vector<report::Series> lines;
  if (whole) lines.push_back(seriesOf(*whole, "all"));
  for (const DepthProfile* region : profiles.largest(kMostRegions)) {
    lines.push_back(seriesOf(*region, region->region));
  }
  const auto range = report::rangeOf(lines);
  report::Series all = lines.empty() ? report::Series{} : lines.front();
  all.spread.clear();
  for (const report::Series& line : lines) {
    const bool isAll = whole && &line == &lines.front();
    const std::string title = profiles.volume + (isAll ? ", all " + profiles.of : ", " + line.name);
    std::vector<report::Series> shown = {line};
    if (!isAll && whole) shown.push_back(all);
    results.content().charts.push_back(
        {isAll ? kProfilePlace : "",
         report::curvesSvg(shown, {title, kDepthAxis, "mean \u00b1 SD", false, {}, range}),
         profiles.volume + " over the depth of the cortex"});
  }
}

/// How the mean of all goes over the frames, at depths from white to pial.
void chartCourse(ResultFolder& results, const VolumeProfiles& profiles) {
  const DepthProfile* whole = profiles.all();
  if (!whole || whole->depths.empty()) return;
  const auto& depths = whole->depths;
  if (depths.begin()->second.mean.size() < 2) return;
  std::vector<report::Series> lines;
  const std::size_t count = std::min(depths.size(), kMostCourses);
  for (std::size_t n = 0; n < count; ++n) {
    const auto at = std::next(
        depths.begin(),
        static_cast<std::ptrdiff_t>(count < 2 ? 0 : n * (depths.size() - 1) / (count - 1)));
    report::Series& line = lines.emplace_back();
    line.name = "depth " + readable(at->first);
    line.y = at->second.mean;
    for (std::size_t f = 0; f < line.y.size(); ++f) line.x.push_back(static_cast<double>(f));
  }
  results.content().charts.push_back(
      {"", report::curvesSvg(lines, {profiles.volume + ", all, over time", "frame", "mean"}),
       profiles.volume + " over time"});
}

/// One row a region: what one depth holds, or the depths' ends and middle.
void tabulate(ResultFolder& results, const VolumeProfiles& profiles) {
  if (profiles.regions.empty() || profiles.regions.front().depths.empty()) return;
  std::set<double> all, shown;
  for (const DepthProfile& profile : profiles.regions) {
    for (const auto& [depth, at] : profile.depths) all.insert(depth);
  }
  const auto nth = [&](std::size_t n) { return *std::next(all.begin(), n); };
  for (const std::size_t n : {std::size_t{0}, (all.size() - 1) / 2, all.size() - 1}) {
    shown.insert(nth(n));
  }
  report::ReportTable table{"",
                            profiles.volume + " by region",
                            "Mean \u00b1 standard deviation over " + profiles.of +
                                "; all depths are in " + profiles.file + ".",
                            {"region", profiles.of},
                            {}};
  for (const double depth : shown) table.columns.push_back("depth " + readable(depth));
  for (const DepthProfile& profile : profiles.regions) {
    if (table.rows.size() >= kMostRows) break;
    std::vector<std::string> row = {profile.region, readable(profile.count)};
    for (const double depth : shown) {
      const auto at = profile.depths.find(depth);
      row.push_back(at == profile.depths.end() ? ""
                                               : readable(at->second.average()) + " \u00b1 " +
                                                     readable(at->second.spread()));
    }
    table.rows.push_back(std::move(row));
  }
  results.content().tables.push_back(std::move(table));
}

void show(ResultFolder& results, const VolumeProfiles& profiles) {
  const bool several = std::ranges::any_of(
      profiles.regions, [](const DepthProfile& p) { return p.depths.size() > 1; });
  if (several) chartProfiles(results, profiles);
  chartCourse(results, profiles);
  if (!several || profiles.regions.size() > 1) tabulate(results, profiles);
}

}  // namespace

void showProfiles(ResultFolder& results, const StepFolder& step) {
  for (const VolumeProfiles& profiles : readDepthProfiles(step.folder)) show(results, profiles);
}

}  // namespace explica::pipeline
