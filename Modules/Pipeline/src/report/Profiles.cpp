// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Chart.h"
#include "ReportParts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace explica::pipeline {
namespace {

constexpr const char* kAll = "all";  // the row of all regions together

/// Means over a region at one depth, frame by frame.
struct AtDepth {
  std::vector<double> mean, deviation;

  [[nodiscard]] double average() const { return averageOf(mean, 1); }
  /// Root mean square of the deviations of the frames.
  [[nodiscard]] double spread() const { return std::sqrt(averageOf(deviation, 2)); }

 private:
  /// Mean of the known values, each to the power of 1 or 2.
  static double averageOf(const std::vector<double>& values, int power) {
    double sum = 0, count = 0;
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      sum += power == 2 ? value * value : value;
      ++count;
    }
    return sum / count;
  }
};

/// A region's profile of one volume: by depth, 0 at the white surface and 1 at the pial.
struct DepthProfile {
  std::string region;
  std::map<double, AtDepth> depths;
  double count = 0;  ///< vertices or voxels, at most at one depth
};

/// What `explica sample` says of one volume, region by region in its table's order.
struct VolumeProfiles {
  std::string volume;
  std::string of;    ///< what is counted: "vertices" or "voxels"
  std::string file;  ///< the table's name
  std::vector<DepthProfile> regions;

  /// The profile of all; nullptr where there is none.
  [[nodiscard]] const DepthProfile* all() const {
    const auto found = std::ranges::find(regions, kAll, &DepthProfile::region);
    return found == regions.end() ? nullptr : &*found;
  }
  /// The others that have any vertex, the largest first, at most so many.
  [[nodiscard]] std::vector<const DepthProfile*> largest(std::size_t most) const {
    std::vector<const DepthProfile*> chosen;
    for (const DepthProfile& profile : regions) {
      if (profile.region != kAll && profile.count > 0) chosen.push_back(&profile);
    }
    std::ranges::stable_sort(chosen, std::ranges::greater{}, &DepthProfile::count);
    if (chosen.size() > most) chosen.resize(most);
    return chosen;
  }
};

/// A row of a table, of the volume that its file is about.
void add(const TableRow& row, VolumeProfiles& profiles) {
  auto profile = std::ranges::find(profiles.regions, cellIn(row, "region"), &DepthProfile::region);
  if (profile == profiles.regions.end()) {
    profile = profiles.regions.insert(profile, {cellIn(row, "region"), {}, 0});
  }
  AtDepth& at = profile->depths[numberIn(row, "depth")];
  at.mean.push_back(numberIn(row, "mean"));
  at.deviation.push_back(numberIn(row, "sd"));
  profile->count = std::max(profile->count, numberIn(row, "n"));
}

/// Profiles in a folder of `explica sample`: of profiles.tsv and of every NAME_layers.tsv.
std::vector<VolumeProfiles> readProfiles(const StepFolder& step) {
  constexpr const char* kProfiles = "profiles.tsv";
  constexpr std::string_view kLayers = "_layers.tsv";
  std::vector<VolumeProfiles> all;
  const Table table = step.has(kProfiles) ? readTable(step.folder / kProfiles) : Table{};
  for (const TableRow& row : table.rows) {
    const std::string& volume = cellIn(row, "volume");
    auto profiles = std::ranges::find(all, volume, &VolumeProfiles::volume);
    if (profiles == all.end()) {
      profiles = all.insert(profiles, {volume, "vertices", kProfiles, {}});
    }
    add(row, *profiles);
  }
  for (const std::filesystem::path& file : filesOf(step, kLayers)) {
    const std::string name = file.filename().string();
    all.push_back({name.substr(0, name.size() - kLayers.size()), "voxels", name, {}});
    for (const TableRow& row : readTable(file).rows) add(row, all.back());
  }
  return all;
}

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
  for (const DepthProfile* region : profiles.largest(11)) {
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
         report::curvesSvg(shown,
                           {title, "depth (0 white, 1 pial)", "mean \u00b1 SD", false, {}, range}),
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
  const std::size_t count = std::min(depths.size(), std::size_t{5});
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
    if (table.rows.size() >= 80) break;
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
  for (const VolumeProfiles& profiles : readProfiles(step)) show(results, profiles);
}

}  // namespace explica::pipeline
