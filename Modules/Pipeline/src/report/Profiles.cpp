// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "../Table.h"
#include "Explica/Report/Chart.h"
#include "ReportParts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace explica::pipeline {
namespace {

constexpr std::size_t kMostRegions = 11;  // with a chart of their own
constexpr std::size_t kMostRows = 80;     // of a table
constexpr std::size_t kMostCourses = 5;   // depths over time in one chart
constexpr const char* kDepthAxis = "depth (0 white, 1 pial)";

/// Means at one depth, frame by frame.
struct AtDepth {
  std::vector<double> mean, deviation;

  [[nodiscard]] double average() const { return averageOf(mean, 1); }
  /// Root mean square of the deviations of the frames.
  [[nodiscard]] double spread() const { return std::sqrt(averageOf(deviation, 2)); }

 private:
  static double averageOf(const std::vector<double>& values, int power) {
    double sum = 0;
    std::size_t count = 0;
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      sum += power == 2 ? value * value : value;
      ++count;
    }
    return count == 0 ? kNaN : sum / static_cast<double>(count);
  }
};

/// A region's profile of one volume.
struct Profile {
  std::string region;
  std::map<double, AtDepth> depths;
  double count = 0;  ///< vertices or voxels, at most at one depth

  [[nodiscard]] report::Series series(const std::string& name) const {
    report::Series line{name, {}, {}};
    for (const auto& [depth, at] : depths) {
      line.x.push_back(depth);
      line.y.push_back(at.average());
      line.spread.push_back(at.spread());
    }
    return line;
  }
};

/// Rows of a table that belong to one volume, by region in the table's order.
std::vector<Profile> profilesOf(const Table& table, const std::string& volume) {
  const auto* volumes = table.text("volume");
  const auto* regions = table.text("region");
  const auto *depth = table.column("depth"), *mean = table.column("mean"),
             *deviation = table.column("sd"), *count = table.column("n");
  std::vector<Profile> profiles;
  if (!regions || !depth || !mean || !deviation || !count) return profiles;
  std::map<std::string, std::size_t> number;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (volumes && (*volumes)[row] != volume) continue;
    const auto [found, isNew] = number.emplace((*regions)[row], profiles.size());
    if (isNew) profiles.push_back({(*regions)[row], {}, 0});
    Profile& profile = profiles[found->second];
    AtDepth& at = profile.depths[(*depth)[row]];
    at.mean.push_back((*mean)[row]);
    at.deviation.push_back((*deviation)[row]);
    profile.count = std::max(profile.count, (*count)[row]);
  }
  return profiles;
}

/// The largest regions, and the profile of all.
struct Chosen {
  std::vector<const Profile*> regions;
  const Profile* all = nullptr;
};

Chosen choose(const std::vector<Profile>& profiles) {
  Chosen chosen;
  for (const Profile& profile : profiles) {
    if (profile.region == "all") {
      chosen.all = &profile;
    } else if (profile.count > 0) {
      chosen.regions.push_back(&profile);
    }
  }
  std::stable_sort(chosen.regions.begin(), chosen.regions.end(),
                   [](const Profile* a, const Profile* b) { return a->count > b->count; });
  if (chosen.regions.size() > kMostRegions) chosen.regions.resize(kMostRegions);
  return chosen;
}

/// A chart a region on one scale, the mean with a band of one standard deviation to either side,
/// and the mean of all for comparison.
void chartProfiles(ResultFolder& results, const std::vector<Profile>& profiles,
                   const std::string& volume, const std::string& of) {
  const Chosen chosen = choose(profiles);
  std::vector<report::Series> lines;
  if (chosen.all) lines.push_back(chosen.all->series("all"));
  for (const Profile* region : chosen.regions) lines.push_back(region->series(region->region));
  const auto range = report::rangeOf(lines);
  report::Series all = lines.empty() ? report::Series{} : lines.front();
  all.spread.clear();
  for (const report::Series& line : lines) {
    const bool isAll = chosen.all && &line == &lines.front();
    const std::string title = volume + (isAll ? ", all " + of : ", " + line.name);
    std::vector<report::Series> shown = {line};
    if (!isAll && chosen.all) shown.push_back(all);
    results.content().charts.push_back(
        {isAll ? kProfilePlace : "",
         report::curvesSvg(shown, {title, kDepthAxis, "mean \u00b1 SD", false, {}, range}),
         volume + " over the depth of the cortex"});
  }
}

/// How the mean of all goes over the frames, at depths from white to pial.
void chartCourse(ResultFolder& results, const std::vector<Profile>& profiles,
                 const std::string& volume) {
  const Chosen chosen = choose(profiles);
  if (!chosen.all || chosen.all->depths.empty()) return;
  const auto& depths = chosen.all->depths;
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
      {"", report::curvesSvg(lines, {volume + ", all, over time", "frame", "mean"}),
       volume + " over time"});
}

/// One row a region: what one depth holds, or the depths' ends and middle.
void tabulate(ResultFolder& results, const std::vector<Profile>& profiles,
              const std::string& volume, const std::string& file, const std::string& of) {
  if (profiles.empty() || profiles.front().depths.empty()) return;
  std::set<double> all, shown;
  for (const Profile& profile : profiles) {
    for (const auto& [depth, at] : profile.depths) all.insert(depth);
  }
  const auto nth = [&](std::size_t n) { return *std::next(all.begin(), n); };
  for (const std::size_t n : {std::size_t{0}, (all.size() - 1) / 2, all.size() - 1}) {
    shown.insert(nth(n));
  }
  report::ReportTable table{
      "",
      volume + " by region",
      "Mean \u00b1 standard deviation over " + of + "; all depths are in " + file + ".",
      {"region", of},
      {}};
  for (const double depth : shown) table.columns.push_back("depth " + readable(depth));
  for (const Profile& profile : profiles) {
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

void show(ResultFolder& results, const Table& table, const std::string& volume,
          const std::string& file, const std::string& of) {
  const std::vector<Profile> profiles = profilesOf(table, volume);
  const bool several = std::any_of(profiles.begin(), profiles.end(),
                                   [](const Profile& p) { return p.depths.size() > 1; });
  if (several) chartProfiles(results, profiles, volume, of);
  chartCourse(results, profiles, volume);
  if (!several || profiles.size() > 1) tabulate(results, profiles, volume, file, of);
}

}  // namespace

void showProfiles(ResultFolder& results, const StepFolder& step) {
  if (step.has("profiles.tsv")) {
    const Table table = readTable(step.folder / "profiles.tsv");
    std::vector<std::string> volumes;
    if (const auto* names = table.text("volume")) {
      for (const std::string& name : *names) {
        if (std::find(volumes.begin(), volumes.end(), name) == volumes.end()) {
          volumes.push_back(name);
        }
      }
    }
    for (const std::string& volume : volumes) {
      show(results, table, volume, "profiles.tsv", "vertices");
    }
  }
  constexpr std::string_view kEnding = "_layers.tsv";
  for (const std::filesystem::path& file : filesOf(step, kEnding)) {
    std::string volume = file.filename().string();
    volume.resize(volume.size() - kEnding.size());
    show(results, readTable(file), volume, file.filename().string(), "voxels");
  }
}

}  // namespace explica::pipeline
